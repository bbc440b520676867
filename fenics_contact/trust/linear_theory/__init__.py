"""Strains, rotations and indentations beyond what linear theory holds for."""
