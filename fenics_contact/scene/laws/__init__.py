"""Laws of a contact that have a table of their own in a scene: across it and along it."""
