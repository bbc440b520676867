"""Cases of ``fenics-contact verify`` about temperatures."""
