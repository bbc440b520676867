"""The area as a table."""


def tables(result):
    """Rows of ``pressed_area.csv``, its header first."""
    steps = result.further["pressed_area"]["steps"]
    return {"pressed_area.csv": [["time", "area"], *([str(x) for x in step] for step in steps)]}
