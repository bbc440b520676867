"""Laws of friction beside Coulomb's, against formulas for bodies that are much stiffer."""
