"""Criteria of fatigue under loads of several axes, of histories of stress; NumPy alone."""
