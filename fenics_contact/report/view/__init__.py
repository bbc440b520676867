"""The interactive view in 3D."""
