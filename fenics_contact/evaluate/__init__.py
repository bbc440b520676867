"""Numbers of a solution: forces at nodes, pressures, areas, resultants, energies.

Pressures are recovered from forces, as in the paper's (1.6) and (4.4).
"""
