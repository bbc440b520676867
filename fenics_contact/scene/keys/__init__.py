"""What is read off the classes of a scene: its reference, its schema; and keys that are added."""
