"""The paper's (3.4) for large bodies in 3D: multigrid, and the contacts' cells solved directly.

Cai and Li (2011), doi 10.1137/080736272.
"""
