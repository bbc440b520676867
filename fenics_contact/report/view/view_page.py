"""The interactive view as a part of a page: its data, packed, its buttons and its scripts."""

from __future__ import annotations

import base64
import gzip
import json
from importlib import resources

import numpy as np
from markupsafe import Markup

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.report.drawing.units import unit_of
from fenics_contact.report.page.templates import render
from fenics_contact.report.view.surface import boundary
from fenics_contact.report.view.view_3d import View
from fenics_contact.results.contact_points import BODY_OF_CELLS

_MOST_LINES = 60_000  # pieces of cells' sides
_MEASURED = {
    "displacement": "length",
    **dict.fromkeys(("von Mises stress", "contact pressure", "friction traction"), "stress"),
}


def view_html(view: View) -> Markup:
    """The part of a page that holds the view, with all it needs; plotly's script is in it."""
    from plotly.offline import get_plotlyjs

    data = json.dumps(_data(view), ensure_ascii=False, allow_nan=False)
    script = resources.files(__package__).joinpath("view_3d.js").read_text(encoding="utf-8")
    return Markup(
        render(
            "view.html",
            buttons=_buttons(view),
            label=f"Interactive view of the body, coloured by {', '.join(view.shown)} or contact "
            "status.",
            help=_help(view),
            data=Markup(packed(data)),
            plotly=Markup(packed(get_plotlyjs())),
            script=Markup(script),
        )
    )


def packed(text: str) -> str:
    """Text in less space, as a browser unpacks it: gzip, in letters."""
    return base64.b64encode(gzip.compress(text.encode(), mtime=0)).decode("ascii")


def _data(view: View) -> dict[str, object]:
    surface = view.surface
    lines = surface.lines if len(surface.lines) <= _MOST_LINES else surface.lines[:0]
    status = surface.fields["status"]
    obstacles = view.of_steps("obstacle")
    there = np.any([np.isfinite(obstacle).all(axis=1) for obstacle in obstacles], axis=0)
    edges = boundary(surface.triangles) if view.is_flat else surface.lines
    part = surface.fields.get(BODY_OF_CELLS, np.zeros(len(surface.points)))
    return {
        "flat": view.is_flat,
        "points": _floats(surface.points),
        "triangles": _integers(surface.triangles),
        "lines": _integers(lines),
        "parts": view.bodies,
        "partOfPoints": _integers(part.astype(np.int64)),
        "times": view.times,
        "displacement": [_floats(values) for values in _lighter(view.of_steps("displacement"))],
        "fields": [_field(name, symbol, view) for name, symbol in view.shown.items()],
        "status": _statuses(view) if (status >= 0).any() else None,
        "statusNames": [kind.label for kind in view.kinds],
        "statusColours": [kind.colour for kind in view.kinds],
        "obstacle": [_where_known(values) for values in obstacles] if there.any() else None,
        "obstacleTriangles": _integers(surface.triangles[there[surface.triangles].all(axis=1)]),
        "obstacleLines": _integers(edges[there[edges].all(axis=1)]),
        "factors": view.factors,
        "zone": None if view.zone is None else view.zone.tolist(),
        "towards": view.towards.tolist(),
        "unit": unit_of("length"),
    }


def _where_known(obstacle: Array) -> str | None:
    """Where obstacles stand; None where nothing touches, so that it is not known."""
    return _floats(np.nan_to_num(obstacle)) if np.isfinite(obstacle).any() else None


def _statuses(view: View) -> list[str]:
    return [_floats(values) for values in view.of_steps("status")]


def _field(name: str, symbol: str, view: View) -> dict[str, object]:
    """A field with the ends of its colours; what a few points alone have is beyond them."""
    steps = view.of_steps(name)
    if name == "displacement":
        steps = [np.linalg.norm(vectors, axis=1) for vectors in steps]
    low, most, high = np.max([np.percentile(values, [0, 99.5, 100]) for values in steps], axis=0)
    low = min(float(values.min()) for values in steps)
    peaked = high > 3 * most > 0 and name == "von Mises stress"
    top = float(most if peaked else high)
    return {
        "name": name,
        "symbol": symbol,
        "unit": unit_of(_MEASURED.get(name, "")),
        "values": [_floats(values) for values in _lighter(steps)],
        "low": 0.0 if low < 0.05 * high else float(low),
        "high": top if top > 0 else 1.0,
        "beyond": f"up to {high:.3g} at single points" if peaked else "",
    }


def _lighter(steps: list[Array]) -> list[Array]:
    """All but the last with 12 binary digits only, which can be packed."""
    return [*(_rounded(values) for values in steps[:-1]), steps[-1]]


def _rounded(values: Array) -> Array:
    bits = values.astype(np.float32).view(np.uint32) + np.uint32(1 << 10)
    return np.asarray((bits & np.uint32(0xFFFFF800)).view(np.float32), dtype=float)


def _floats(values: Array) -> str:
    return base64.b64encode(values.astype("<f4").tobytes()).decode()


def _integers(values: Integers) -> str:
    return base64.b64encode(values.astype("<i4").tobytes()).decode()


def _buttons(view: View) -> list[tuple[str, str, list[str]]]:
    """Groups of buttons: of what, with which title, named how."""
    names = [*view.shown, *(["status"] if (view.surface.fields["status"] >= 0).any() else [])]
    words = {0.0: "undeformed", 1.0: "true displacements"}
    factors = [words.get(factor, f"displacements × {factor:g}") for factor in view.factors]
    groups = [("field", "Colours", names), ("factor", "Shape", factors)]
    if view.zone is not None:
        groups.append(("zone", "View", ["whole", "contact zone"]))
    groups.append(("lines", "Cells", ["shown", "hidden"]))
    if np.isfinite(view.surface.fields["obstacle"]).any():
        groups.append(("obstacle", "Obstacle", ["shown", "hidden"]))
    if len(view.bodies) > 1:
        states = ["shown", "faded", "hidden"]
        groups += [(f"part{number}", name, states) for number, name in enumerate(view.bodies)]
    return groups


def _help(view: View) -> str:
    words = "Drag to turn the body" if not view.is_flat else "Drag to move it"
    words += ", scroll or pinch to come nearer, point at it for its values."
    if view.kinematics == "axisymmetric":
        words += " The section is turned around its axis, which is z here; a quarter is cut out."
    if len(view.bodies) > 1:
        words += " Fade or hide bodies to see the surfaces between them."
    return words
