"""Pictures of deformed bodies and obstacles."""
