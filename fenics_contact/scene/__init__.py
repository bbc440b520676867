"""The scene that a user describes, as frozen data: its tables, read from TOML and written to it.

The data of the paper's (1.1) to (1.8). No FEniCSx.
"""
