"""``fenics-contact sweep``: its options, and what it says."""
