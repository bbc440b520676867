"""Checks of answers in finite strains."""
