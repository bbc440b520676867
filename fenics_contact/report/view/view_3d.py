"""The interactive view of a run: what it shows, as data of a page; drawn by plotly there."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import resources
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup
from scipy.spatial import cKDTree

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.report.bodies.obstacles import ObstacleSurface, obstacles_of
from fenics_contact.report.drawing.style import Mark, marks, neighbourhood
from fenics_contact.report.drawing.units import unit_of
from fenics_contact.report.page.templates import render
from fenics_contact.report.view.revolved import revolved
from fenics_contact.report.view.surface import Surface, boundary, surface_of
from fenics_contact.results.contact_table import ContactTable
from fenics_contact.results.point_arrays import PointArray, of_several_contacts
from fenics_contact.results.records.run import Outcome

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid

_MOVE = 0.06  # of what is shown: the largest displacement, where it is magnified
_READABLE = 0.02  # from which it is seen as it is
_MISFIT = 0.01  # of what is shown: false gaps and overlaps that magnification may make
_NEAR = 0.4  # share of the body, below which the contact zone can be looked at from near by
_MOST_LINES = 60_000  # pieces of cells' sides
_MEASURED = {
    "displacement": "length",
    **dict.fromkeys(("von Mises stress", "contact pressure", "friction traction"), "stress"),
}


@dataclass(frozen=True)
class View:
    """What the view shows.

    Attributes:
        surface: With the fields `displacement`, `status` (a number of ``kinds``, or -1 off the
            contacts), `obstacle`, and those that colours show.
        kinematics: Of the model.
        kinds: How the states of contact points are called, and look; the open one first.
        shown: Name of a field → its symbol.
        factors: Of the displacements, that one can choose between.
        zone: Lowest and highest coordinates of the contact zone, (2, 3), if it is small.
        towards: From the body to the eye, (3,).
    """

    surface: Surface
    kinematics: str
    kinds: tuple[Mark, ...]
    shown: dict[str, str]
    factors: list[float]
    zone: Array | None
    towards: Array

    @property
    def is_flat(self) -> bool:
        """Whether it is a plane model."""
        return self.kinematics.startswith("plane")


def make_view(body: UnstructuredGrid, result: Outcome, table: ContactTable) -> View:
    """The view of a run.

    Args:
        body: A pyvista grid with the fields of its last step, and `von Mises stress`.
        result: The content of its ``result.json``.
        table: The content of its ``contact.csv``.
    """
    kinematics = result.model.kinematics
    shown = {"von Mises stress": "σ_VM", "displacement": "|u|"}
    fields = {name: np.asarray(body[name], dtype=float) for name in ("displacement", "status")}
    kinds = _kinds(result)
    fields["status"] = np.minimum(fields["status"], len(kinds) - 1)
    fields["von Mises stress"] = np.asarray(body["von Mises stress"], dtype=float)
    if (fields["status"] >= 0).any():
        fields["contact pressure"] = np.asarray(body["contact_pressure"], dtype=float)
        shown["contact pressure"] = "p"
        friction = np.linalg.norm(np.asarray(body["friction_traction"], dtype=float), axis=1)
        if friction.any():
            fields["friction traction"] = friction
            shown["friction traction"] = "|σ_T|"
        for array, values in _own(body, result):
            unit = unit_of(array.unit) or array.unit
            fields[array.words], shown[array.words] = values, f"({unit})"
    contacts = [(table.of(contact.name), contact) for contact in result.contacts]
    fields["obstacle"] = _obstacles(body, obstacles_of(body, contacts))
    make = revolved if kinematics == "axisymmetric" else surface_of
    surface = make(body, fields)
    front = np.zeros(3)
    if kinematics == "3D" and len(table.status):
        front = table.vectors("nx", "ny", "nz").mean(axis=0)
    zone = _zone(surface)
    factors = _factors(surface, zone, result)
    aside = np.zeros(3)
    if kinematics == "3D" and zone is not None:
        low, high = surface.points.min(axis=0), surface.points.max(axis=0)
        aside = (zone.sum(axis=0) - low - high) / (high - low).max()
    return View(surface, kinematics, kinds, shown, factors, zone, _towards(front, aside))


def _own(body: UnstructuredGrid, result: Outcome) -> Iterator[tuple[PointArray, Array]]:
    """What laws keep of their own at the nodes, vectors by their length, unless it is all zero."""
    arrays = [array for contact in result.contacts for array in contact.own_arrays]
    for array in of_several_contacts(arrays):
        values = np.asarray(body[array.name], dtype=float)
        values = np.linalg.norm(values, axis=1) if array.is_vector else values
        if values.any():
            yield array, values


def _kinds(result: Outcome) -> tuple[Mark, ...]:
    """States of contact points: open, stick and slip, or without any friction open and closed."""
    *closed, still_open = marks(*result.contacts)
    return still_open, *closed


def _obstacles(body: UnstructuredGrid, obstacles: list[ObstacleSurface]) -> Array:
    """Where obstacles stand, from the undeformed places of nodes opposite, (nodes, 3) (length).

    Not a number where there is none. A node of several pieces of the body is there in each.
    """
    found = np.full((body.n_points, 3), np.nan)
    on_contact = np.flatnonzero(np.asarray(body["status"]) >= 0)
    for obstacle in obstacles:
        places = np.asarray(body.points, dtype=float)[on_contact]
        distance, nearest = cKDTree(obstacle.points).query(places)
        same = distance < 1e-9 * np.ptp(np.asarray(body.points), axis=0).max()
        offsets = obstacle.offsets[:, None] * obstacle.normals
        found[on_contact[same]] = offsets[nearest[same]]
    return found


def _factors(surface: Surface, zone: Array | None, result: Outcome) -> list[float]:
    """Undeformed, as it is and, where that is too little to be seen, magnified.

    Gaps between bodies are not magnified: those that have closed would seem open, or overlapped.
    """
    largest = np.linalg.norm(surface.fields["displacement"], axis=1).max()
    size = np.linalg.norm(np.ptp(surface.points if zone is None else zone, axis=0))
    if largest == 0 or largest >= _READABLE * size:
        return [0.0, 1.0]
    factor = _round(_MOVE * size / largest)
    pairs = [contact for contact in result.contacts if contact.master is not None]
    gap = max((contact.quantities["closed_gap"] for contact in pairs), default=0.0)
    return [0.0, 1.0, factor] if factor * gap <= _MISFIT * size else [0.0, 1.0]


def _round(factor: float) -> float:
    """1, 2 or 5 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(factor))
    return float(power * max(step for step in (1, 2, 5) if step * power <= factor * 1.000001))


def _zone(surface: Surface) -> Array | None:
    """The neighbourhood of what touches, if it is small in the body."""
    on_contact = surface.fields["status"] >= 0
    if not on_contact.any():
        return None
    closed = surface.fields["status"][on_contact] > 0
    low, high = neighbourhood(surface.points[on_contact], closed)
    if (high - low).max() >= _NEAR * np.ptp(surface.points, axis=0).max():
        return None
    return np.array([low, high])


def _towards(front: Array, aside: Array) -> Array:
    """Before the contact surface, and on that side of the body to which the zone is shifted.

    Of bodies of revolution it looks into the quarter that is cut out.
    """
    side = np.where(aside < -0.05, -1.0, 1.0)
    side = np.where(np.abs(front) > 0.1, np.sign(front), side)
    return np.asarray(side / np.sqrt(3))


def view_html(view: View) -> Markup:
    """The part of a page that holds the view, with all it needs; plotly's script is in it."""
    from plotly.offline import get_plotlyjs

    data = json.dumps(_data(view), ensure_ascii=False, allow_nan=False).replace("<", "\\u003c")
    script = resources.files(__package__).joinpath("view_3d.js").read_text(encoding="utf-8")
    return Markup(
        render(
            "view.html",
            buttons=_buttons(view),
            label=f"Interactive view of the body, coloured by {', '.join(view.shown)} or contact "
            "status.",
            help=_help(view),
            data=Markup(data),
            plotly=Markup(get_plotlyjs()),
            script=Markup(script),
        )
    )


def _data(view: View) -> dict[str, object]:
    surface = view.surface
    lines = surface.lines if len(surface.lines) <= _MOST_LINES else surface.lines[:0]
    displacement = surface.fields["displacement"]
    size = np.linalg.norm(displacement, axis=1)
    values = surface.fields | {"displacement": size}
    fields = [_field(name, symbol, values[name]) for name, symbol in view.shown.items()]
    status = surface.fields["status"]
    obstacle = surface.fields["obstacle"]
    there = np.isfinite(obstacle).all(axis=1)
    edges = boundary(surface.triangles) if view.is_flat else surface.lines
    return {
        "flat": view.is_flat,
        "points": _floats(surface.points),
        "displacement": _floats(displacement),
        "triangles": _integers(surface.triangles),
        "lines": _integers(lines),
        "fields": fields,
        "status": None if not (status >= 0).any() else _floats(status),
        "statusOfTriangles": _floats(np.median(status[surface.triangles], axis=1)),
        "statusNames": [kind.label for kind in view.kinds],
        "statusColours": [kind.colour for kind in view.kinds],
        "obstacle": _floats(np.nan_to_num(obstacle)) if there.any() else None,
        "obstacleTriangles": _integers(surface.triangles[there[surface.triangles].all(axis=1)]),
        "obstacleLines": _integers(edges[there[edges].all(axis=1)]),
        "factors": view.factors,
        "zone": None if view.zone is None else view.zone.tolist(),
        "towards": view.towards.tolist(),
        "unit": unit_of("length"),
    }


def _field(name: str, symbol: str, values: Array) -> dict[str, object]:
    """A field with the ends of its colours; what a few points alone have is beyond them."""
    low, most, high = np.percentile(values, [0, 99.5, 100])
    peaked = high > 3 * most > 0 and name == "von Mises stress"
    top = float(most if peaked else high)
    return {
        "name": name,
        "symbol": symbol,
        "unit": unit_of(_MEASURED.get(name, "")),
        "values": _floats(values),
        "low": 0.0 if low < 0.05 * high else float(low),
        "high": top if top > 0 else 1.0,
        "beyond": f"up to {high:.3g} at single points" if peaked else "",
    }


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
        groups.append(("zone", "Part", ["whole", "contact zone"]))
    groups.append(("lines", "Cells", ["shown", "hidden"]))
    if np.isfinite(view.surface.fields["obstacle"]).any():
        groups.append(("obstacle", "Obstacle", ["shown", "hidden"]))
    return groups


def _help(view: View) -> str:
    words = "Drag to turn the body" if not view.is_flat else "Drag to move it"
    words += ", scroll or pinch to come nearer, point at it for its values."
    if view.kinematics == "axisymmetric":
        words += " The section is turned around its axis, which is z here; a quarter is cut out."
    return words
