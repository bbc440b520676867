"""The page itself, of files that are all served by the program: nothing comes from elsewhere."""

from __future__ import annotations

import itertools
import json
from collections.abc import Sequence
from importlib import resources

from markupsafe import Markup

from fenics_contact.common.wording import one_line
from fenics_contact.explore.keys import MovedKey
from fenics_contact.explore.server import File
from fenics_contact.report import page as report_page
from fenics_contact.report.drawing.style import COLOURS
from fenics_contact.report.gallery import require
from fenics_contact.report.page.templates import render
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.units.table import names_of

_SCRIPT, _STYLE = "text/javascript; charset=utf-8", "text/css; charset=utf-8"


def files_of(scene: Scene, keys: Sequence[MovedKey]) -> dict[str, File]:
    """Name → file of the page, which has no name itself.

    Args:
        scene: What is explored.
        keys: What is moved.

    Raises:
        InputError: The model is in space, and plotly is missing.
    """
    own, report = resources.files(__package__), resources.files(report_page.__name__)
    found = {
        "": File(_page(scene, keys).encode(), "text/html; charset=utf-8"),
        "drawing.js": File(own.joinpath("drawing.js").read_bytes(), _SCRIPT),
        "explore.js": File(own.joinpath("explore.js").read_bytes(), _SCRIPT),
        "explore.css": File(own.joinpath("explore.css").read_bytes(), _STYLE),
        "report.css": File(report.joinpath("report.css").read_bytes(), _STYLE),
    }
    if scene.dimension == 3:  # what is flat is drawn without it
        require("plotly")
        from plotly.offline import get_plotlyjs

        found["plotly.js"] = File(get_plotlyjs().encode(), _SCRIPT)
    return found


def _page(scene: Scene, keys: Sequence[MovedKey]) -> str:
    grouped = itertools.groupby(keys, lambda one: one.number.of or "scene")
    data = {
        "keys": {
            one.key: {
                "low": one.low,
                "high": one.high,
                "start": one.start,
                "whole": one.number.is_whole,
                "anew": one.makes_anew,
            }
            for one in keys
        },
        "units": _units(scene),
        "colours": [COLOURS[word] for word in ("OPEN", "STICK", "SLIP")],
    }
    text = json.dumps(data, allow_nan=False).replace("<", "\\u003c")
    return render(
        "explore.html",
        title=one_line(scene.title or "fenics-contact explore"),
        sheets=["report.css", "explore.css"],
        groups=[(group, list(found)) for group, found in grouped],
        units={one.key: one.number.unit(scene) for one in keys},
        notes=_notes(scene, keys),
        in_space=scene.dimension == 3,
        data=Markup(text),
    )


def _units(scene: Scene) -> dict[str, str]:
    """Return the units of lengths and stresses; empty in a scene without units."""
    names = names_of(scene)
    measured = ("length", "stress")
    return {each: "" if names is None else names.of(each) for each in measured}


def _notes(scene: Scene, keys: Sequence[MovedKey]) -> list[str]:
    """Return remarks on all answers."""
    notes = []
    if scene.load_steps.several:
        notes.append(
            f"Of several load steps, the last is shown, at time {scene.load_steps.last:g}."
        )
    anew = [one.key for one in keys if one.makes_anew]
    if anew:
        notes.append(
            f"The body is made anew for {', '.join(anew)}: the answer comes when you let go."
        )
    return notes
