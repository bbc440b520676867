"""``fenics-contact look``: a CAD or mesh file as a page, and as a scene to complete."""
