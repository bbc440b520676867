"""Thermal strains of a body: by temperatures that are given, or that conduction has found."""
