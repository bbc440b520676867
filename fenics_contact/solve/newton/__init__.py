"""SNES on a system, from an initial guess; what it found, and why it failed.

The paper's (4.3) and (4.7).
"""
