"""Analytic and published cases: the paper's examples 1 to 4, laws of friction, wear, and motion."""
