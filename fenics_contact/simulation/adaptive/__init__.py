"""Mesh after mesh until the estimated errors are those asked for."""
