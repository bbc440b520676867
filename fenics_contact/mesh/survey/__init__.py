"""What a CAD or mesh file holds: its bodies and surfaces, what they are and which face each other."""
