"""Results of a run, as plain data and in words: shared by pages, terminal and files.

No FEniCSx.
"""
