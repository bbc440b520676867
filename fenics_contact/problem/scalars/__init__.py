"""Scalar unknowns: numbers that are found together with the displacements, a class each.

Each is one border of the stiffness: a column, a row and a corner. A new kind is a class in a file
of its own, and a line in ``kinds.py``.
"""
