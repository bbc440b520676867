"""Forces from the bulk against the laws of contact and friction.

The paper's (1.1), (1.6), (2.8) and (4.4).
"""
