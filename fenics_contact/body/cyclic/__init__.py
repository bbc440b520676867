"""The cut faces of a sector of a ring, of which one moves as the other does, turned (u = R u')."""
