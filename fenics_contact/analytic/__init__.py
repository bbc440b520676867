"""Formulas that results are compared with or built on, in NumPy alone.

Half-spaces under forces (Boussinesq, Cerruti, Flamant), contact of round and flat bodies (Hertz,
Cattaneo, Mindlin, punches), plane stress functions (Airy), and in `fatigue` criteria of
fatigue. Each function names its source.
"""
