"""Loads that come again and again."""
