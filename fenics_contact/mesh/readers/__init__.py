"""Mesh files of other programs: each reader gives nodes, elements and named groups of them.

They run in a process of their own (``reader_process``) and import nothing that would start MPI.
"""
