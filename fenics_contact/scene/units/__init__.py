"""Units of a scene: what its numbers measure, values with a unit, names, materials in SI.

Without a table ``[units]`` in a scene nothing in here is asked, and pint is not loaded.
"""
