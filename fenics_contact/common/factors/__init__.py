"""Direct factors of one rank's own sparse matrices, and the calls of PETSc's C library for them."""
