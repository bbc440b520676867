"""Files that Gmsh reads: which it may read, what scripts may say, and Gmsh in its own process."""
