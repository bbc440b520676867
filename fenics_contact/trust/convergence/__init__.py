"""Quantities that no mesh brings to an end, and contacts that a mesh is too coarse for."""
