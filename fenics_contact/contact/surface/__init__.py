"""The discrete surface Γ_C: the mesh of its facets, its spaces, points, weights and normals.

The paper's (3.2) and (4.2): Simpson's points.
"""
