"""What a file holds: its bodies and surfaces, what they are, and which face each other."""
