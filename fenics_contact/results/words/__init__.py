"""Results in words and tables: values with their bars, headlines, short forms.

No FEniCSx in here.
"""
