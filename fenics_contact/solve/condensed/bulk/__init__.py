"""The stiffness condensed onto the contact dofs: one factorisation for any conditions."""
