"""All energy terms and unknowns of a scene: what is minimised.

The paper's (2.9) to (2.11): ½ a(v, v) + j_ε(v) - f(v).
"""
