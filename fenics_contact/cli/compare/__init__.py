"""``fenics-contact compare``: runs side by side on the terminal, and a page of their curves."""
