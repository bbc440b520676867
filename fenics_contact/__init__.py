from fenics_contact import compat
