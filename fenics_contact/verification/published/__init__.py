"""Analytic and published cases, the paper's examples 1 to 4 among them."""
