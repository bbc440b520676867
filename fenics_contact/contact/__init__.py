"""A contact surface as one object: its points, what faces them, gap, slip, pressure, friction.

The paper's (1.2) to (1.8), (2.6) to (2.8) and (4.1) to (4.4).
"""
