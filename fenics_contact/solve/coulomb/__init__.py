"""Friction that is bounded by an unknown pressure: the paper's (4.4) to (4.7), Steps 1 to 4."""
