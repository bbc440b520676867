"""Whether a run is one that has a formula, and the formula's curve."""
