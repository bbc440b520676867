"""From geometries and mesh files to a distributed mesh with named groups.

The paper's domain Ω and the parts Γ_D, Γ_F and Γ_C of its boundary.
"""
