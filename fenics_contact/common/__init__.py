"""What every room needs: errors and exit codes, ranks, versions of dolfinx, files, the terminal.

It knows nothing of contact. Of the rooms above, ``scene``, ``results`` and ``report`` load only
what of it needs no MPI.
"""
