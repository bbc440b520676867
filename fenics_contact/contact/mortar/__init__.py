"""Two surfaces whose meshes do not match: where they face each other, and integrals over that.

From arrays alone. Puso and Laursen (2004), doi 10.1016/j.cma.2003.10.010.
"""
