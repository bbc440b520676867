"""``fenics-contact fit``: its options, and what it says."""
