"""Several runs side by side, from their files: what differs, and by how many error bars.

No FEniCSx in here.
"""
