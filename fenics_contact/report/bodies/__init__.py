"""Pictures of deformed bodies and obstacles, and the interactive view in 3D."""
