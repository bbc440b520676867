"""Cases of ``fenics-contact verify`` about finite strains."""
