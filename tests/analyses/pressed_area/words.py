"""The area on the terminal and in a file."""

from fenics_contact.results.tables import AnalysisWords, headed


def area_rows(result):
    """A row a load step, after the heads."""
    rows = [["time", headed("pressed area", "area", result.units)]]
    return rows + [[f"{t:g}", f"{a:.3g}"] for t, a in result.further["pressed_area"]["steps"]]


class _Words(AnalysisWords):
    def plan(self, scene, units):
        unit = "" if units is None else f" {units.of('stress')}"
        return [f"Pressed area: where pressures are above {scene.pressed_area.above:g}{unit}"]

    def tables(self, result):
        return [area_rows(result)]

    def files(self, result):
        steps = result.further["pressed_area"]["steps"]
        return {"pressed_area.csv": [["time", "area"], *([str(x) for x in step] for step in steps)]}


WORDS = _Words()
