"""Energies of contact and friction in UFL, and the terms that compile and drive them.

The paper's (1.8), (2.6) to (2.8) and (4.1).
"""
