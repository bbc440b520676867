"""The history of stress near contacts, over a cycle of loads, and criteria of fatigue of it."""
