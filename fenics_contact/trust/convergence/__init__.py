"""Quantities that no mesh brings to an end: they get no error bar, and it is said why."""
