"""What a run found, as plain data and in words: all that pages, terminal and files share.

No FEniCSx.
"""
