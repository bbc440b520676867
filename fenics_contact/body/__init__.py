"""The elastic body: its energy ½ a(v, v), finite elements, connected parts, supports, points.

The paper's (1.1), (2.1) and Section 3.
"""
