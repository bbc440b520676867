"""Bodies in finite strains: stored energies of the deformation gradient, derived automatically."""
