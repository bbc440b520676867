"""The page of a sweep: quantities over the varied keys, and the contact at every point."""
