"""Parts for all packages: errors and exit codes, ranks, versions of dolfinx, files, terminal.

It knows nothing of contact. Of the rooms above, ``scene``, ``results`` and ``report`` load only
what of it needs no MPI.
"""
