"""A local page on which numbers of a scene are moved and its answer follows; in notebooks, too.

A thread serves the page (``server``), and exactly one thread solves, as PETSc asks for it; between
the two is an ``exchange`` in which the latest request counts.
"""
