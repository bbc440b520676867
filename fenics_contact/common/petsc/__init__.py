"""PETSc as the program uses it: the options that users give, and MUMPS' factorisations."""
