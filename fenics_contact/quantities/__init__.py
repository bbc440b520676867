"""The quantities of a run: their names, and all that is known of each without an answer.

A quantity is a row of the table: its unit and meaning, how the whole model's is made of those of
contacts, what its errors are measured by. What needs an answer is attached to the row by its name:
its evaluation (``evaluate``) and its derivatives (``simulation.sensitivities``).
"""
