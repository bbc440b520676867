"""Units of a scene: what each of its numbers measures, values with a unit, names of units.

Without a table ``[units]`` in a scene nothing in here is asked, and pint is not loaded.
"""
