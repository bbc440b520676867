"""``fenics-contact explore``: a page on which numbers of a scene are moved."""
