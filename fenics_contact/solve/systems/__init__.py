"""What Newton's method solves, as vectors and matrices: the paper's (3.4) and (4.3)."""
