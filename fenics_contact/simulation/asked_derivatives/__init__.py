"""Requested derivatives: exact for the discrete answer, and as a mean about it.

The exact derivative jumps wherever the edge of contact, or of stick, passes a node. Its mean over a
window in which these edges move by about a cell is that of the continuous problem, but for little.
"""
