"""Contact in the deformed geometry: gaps, normals, slip and areas of current places."""
