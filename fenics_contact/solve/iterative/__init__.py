"""The paper's (3.4) for large bodies in 3D: multigrid, and the contacts' cells solved directly.

X.-C. Cai and X. Li, SIAM J. Sci. Comput. 33 (2011) 746-762.
"""
