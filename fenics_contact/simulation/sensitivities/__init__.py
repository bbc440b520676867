"""Exact derivatives of a discrete answer in the numbers of its scene, by the adjoint.

A quantity's derivatives in what happens (``gradients``) go backwards through the transposed
tangent and the laws (``adjoint``) to those in all that is given; what a number of the scene
changes of that (``scene_changes``) they are multiplied with.
"""
