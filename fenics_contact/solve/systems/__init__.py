"""Systems for Newton's method, as vectors and matrices: the paper's (3.4) and (4.3)."""
