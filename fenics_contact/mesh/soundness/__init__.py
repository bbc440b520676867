"""Checks of a mesh, whatever program wrote it: on plain arrays, after reading.

``cells`` looks at the cells themselves, one by one and by the sides that they share;
``neighbours`` at cells that lie against each other, or in each other, and share no nodes.
"""
