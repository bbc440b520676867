"""Ways to Coulomb friction: bound and traction of every point found together, or by turns."""
