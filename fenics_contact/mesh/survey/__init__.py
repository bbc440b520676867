"""Survey of a file: its bodies and surfaces, their shapes, and which face each other."""
