"""From a scene to a result: a run on one mesh, adaptive meshes, a run's folder, restart."""
