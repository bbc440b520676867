"""The page of a fit: both curves, their difference, and the intervals, from its files only."""
