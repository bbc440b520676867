"""Cells of several types or orders are made cells of one type, as dolfinx needs them.

All readers' meshes go through ``uniform.uniform``, on one rank, before groups are made of them.
"""
