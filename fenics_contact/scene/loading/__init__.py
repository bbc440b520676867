"""How loads go on in pseudo-time: their paths, and what of these comes again and again."""
