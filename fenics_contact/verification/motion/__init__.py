"""Bodies that move: against d'Alembert's bar, Coulomb's oscillator and the midpoint rule."""
