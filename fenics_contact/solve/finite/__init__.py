"""Load steps in finite strains: three nested loops.

The outer one is Newton's method on the body, condensed onto the contact dofs by one factorisation
of its tangent. The middle one measures contact in the deformed geometry, on the contact dofs alone.
The inner one solves the laws of contact and friction exactly where geometry rests.
"""
