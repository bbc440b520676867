"""Error bars by source: mesh, ε₁, ε, iterations, load steps, the far field.

The paper's (2.12), (3.5) and (3.6).
"""
