"""Errors by the mesh: local problems in cells, edges that move through cells, curved sides.

Also what of a body, its loads and given pressures straight or quadratic cells miss.
"""
