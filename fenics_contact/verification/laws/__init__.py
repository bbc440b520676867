"""Laws of friction: what Coulomb's holds, and others, against formulas for stiffer bodies."""
