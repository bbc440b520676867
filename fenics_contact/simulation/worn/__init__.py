"""Cycles of loads that wear, most of which are passed over by what those that are computed wear."""
