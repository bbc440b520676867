"""Pictures over load steps, iterations and meshes."""
