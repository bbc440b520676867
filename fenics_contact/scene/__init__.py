"""What the user says, as frozen data: tables of a scene, read from TOML and written to it.

The data of the paper's (1.1) to (1.8). No FEniCSx.
"""
