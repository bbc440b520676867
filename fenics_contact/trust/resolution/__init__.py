"""Whether the points of a contact are close enough together to see what touches."""
