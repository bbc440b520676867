"""Friction that is bounded by an unknown pressure: the paper's (4.4) to (4.7), Steps 1 to 4.

``alternating_loop`` is the paper's loop, ``monolithic`` Newton's method on the whole, and
``strategies`` chooses between them and their rescues.
"""
