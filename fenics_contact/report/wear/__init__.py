"""The page of many cycles that wear, and its pictures."""
