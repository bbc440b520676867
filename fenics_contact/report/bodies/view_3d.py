"""The interactive view of a run: what it shows."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from fenics_contact.common.arrays import Array
from fenics_contact.common.wording import one_line
from fenics_contact.quantities.names import CLOSED_GAP
from fenics_contact.report.bodies.surface import BodySurface, revolved, surface_of
from fenics_contact.report.bodies.view import ObstacleSurface, choose_view, obstacles_of
from fenics_contact.report.contacts.film import frame_numbers
from fenics_contact.report.drawing.fields import body_of_nodes
from fenics_contact.report.drawing.style import Mark, marks, neighbourhood, unit_of
from fenics_contact.results.contact_points import (
    BODY_OF_CELLS,
    ContactTable,
    PointArray,
    of_several_contacts,
)
from fenics_contact.results.records.run import Model, Outcome

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid

_MOVE = 0.06  # of what is shown: the largest displacement, where it is magnified
_READABLE = 0.02  # from which it is seen as it is
_MISFIT = 0.01  # of what is shown: false gaps and overlaps that magnification may make
_NEAR = 0.4  # share of the body, below which the contact zone can be looked at from near by
# Of the fields of load steps: what may be packed into a page, what a point has at the most, and
# about how many points there are at the most.
_MOST_BYTES, _BYTES_OF_A_POINT, _MOST_POINTS = 5e6, 32, 20_000
_BYTES_OF_A_CONTACT_POINT = 32  # beside these, of its curves or maps


@dataclass(frozen=True)
class View:
    """Content of the view.

    Attributes:
        surface: With the fields `displacement`, `status` (a number of ``kinds``, or -1 off the
            contacts), `obstacle`, and those that colours show.
        kinematics: Of the model.
        kinds: How the states of contact points are called, and look; the open one first.
        shown: Name of a field → its symbol.
        factors: Of the displacements, that one can choose between.
        zone: Lowest and highest coordinates of the contact zone, (2, 3), if it is small.
        towards: From the body to the eye, (3,).
        bodies: Names of the connected parts, by their numbers in the field `body`.
        times: Pseudo-times of the load steps that are shown; fields of all but the last have its
            number before their names, see ``at_step``.
    """

    surface: BodySurface
    kinematics: str
    kinds: tuple[Mark, ...]
    shown: dict[str, str]
    factors: list[float]
    zone: Array | None
    towards: Array
    bodies: list[str]
    times: list[float]

    def of_steps(self, name: str) -> list[Array]:
        """A field in every load step, the last one as the surface itself has it."""
        fields = self.surface.fields
        earlier = [fields[at_step(number, name)] for number in range(len(self.times) - 1)]
        return [*earlier, fields[name]]

    @property
    def is_flat(self) -> bool:
        """Whether it is a plane model."""
        return self.kinematics.startswith("plane")


def at_step(number: int, name: str) -> str:
    """Return the name of a field of an earlier load step."""
    return f"{number}: {name}"


def make_view(
    body: UnstructuredGrid,
    result: Outcome,
    table: ContactTable,
    earlier: Iterable[tuple[float, UnstructuredGrid]] = (),
) -> View:
    """The view of a run.

    Args:
        body: A pyvista grid with the fields of its last step, and `von Mises stress`.
        result: The content of its ``result.json``.
        table: The content of its ``contact.csv``.
        earlier: Pseudo-times of earlier steps, and the same grid with their fields.
    """
    kinematics, kinds = result.model.kinematics, _kinds(result)
    contacts = [(table.of(contact.name), contact) for contact in result.contacts]
    obstacles = obstacles_of(body, contacts)
    shown = {"von Mises stress": "σ_VM", "displacement": "|u|"}
    if "temperature" in body.array_names:
        shown["temperature"] = "T"
    fields, symbols = _fields(body, result, len(kinds) - 1)
    fields["obstacle"] = _obstacles(body, obstacles)
    times = []
    for number, (time, then) in enumerate(earlier):
        now, more = _fields(then, result, len(kinds) - 1)
        symbols |= more
        stood = [moved for one in obstacles if (moved := one.then(then)) is not None]
        now["obstacle"] = _obstacles(body, stood)
        fields |= {at_step(number, name): values for name, values in now.items()}
        times.append(time)
    shown |= symbols
    for name in symbols:  # what is zero in a step is not among its fields
        for number in range(-1, len(times)):
            fields.setdefault(at_step(number, name) if number >= 0 else name, 0 * fields["status"])
    bodies = [one_line(name) for name in result.model.bodies]
    if len(bodies) > 1:
        fields[BODY_OF_CELLS] = body_of_nodes(body).astype(float)
    else:
        bodies = bodies[:1] or ["body"]
    make = revolved if kinematics == "axisymmetric" else surface_of
    surface = make(body, fields)
    zone = _zone(surface)
    towards = np.ones(3) / np.sqrt(3)  # of bodies of revolution into the quarter that is cut out
    if kinematics == "3D":
        towards = choose_view(body, result, table).towards
    times.append(result.steps[-1].load_factor if result.steps else 1.0)
    view = View(surface, kinematics, kinds, shown, [], zone, towards, bodies, times)
    return replace(view, factors=_factors(view, result))


def _fields(
    body: UnstructuredGrid, result: Outcome, most: int
) -> tuple[dict[str, Array], dict[str, str]]:
    """Fields of a step at the nodes, and the symbols of those of contacts that are not zero.

    Args:
        body: The grid with its fields.
        result: The content of ``result.json``.
        most: The highest status.
    """
    fields = {name: np.asarray(body[name], dtype=float) for name in ("displacement", "status")}
    fields["status"] = np.minimum(fields["status"], most)
    fields["von Mises stress"] = np.asarray(body["von Mises stress"], dtype=float)
    if "temperature" in body.array_names:
        fields["temperature"] = np.asarray(body["temperature"], dtype=float)
    symbols: dict[str, str] = {}
    if (fields["status"] >= 0).any():
        fields["contact pressure"] = np.asarray(body["contact_pressure"], dtype=float)
        symbols["contact pressure"] = "p"
        friction = np.linalg.norm(np.asarray(body["friction_traction"], dtype=float), axis=1)
        if friction.any():
            fields["friction traction"] = friction
            symbols["friction traction"] = "|σ_T|"
        for array, values in _own(body, result):
            unit = unit_of(array.unit) or array.unit
            fields[array.words], symbols[array.words] = values, f"({unit})"
    return fields, symbols


def _own(body: UnstructuredGrid, result: Outcome) -> Iterator[tuple[PointArray, Array]]:
    """Yield state variables of laws at the nodes that are not all zero, vectors by length."""
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


def _factors(view: View, result: Outcome) -> list[float]:
    """Undeformed, as it is and, where that is too little to be seen, magnified.

    Gaps between bodies are not magnified: those that have closed would seem open, or overlapped.
    """
    moved = view.of_steps("displacement")
    largest = max(float(np.linalg.norm(vectors, axis=1).max()) for vectors in moved)
    box = view.surface.points if view.zone is None else view.zone
    size = float(np.linalg.norm(np.ptp(box, axis=0)))
    if largest == 0 or largest >= _READABLE * size:
        return [0.0, 1.0]
    factor = _round(_MOVE * size / largest)
    pairs = [contact for contact in result.contacts if contact.master is not None]
    gap = max((contact.quantities[CLOSED_GAP] for contact in pairs), default=0.0)
    return [0.0, 1.0, factor] if factor * gap <= _MISFIT * size else [0.0, 1.0]


def _round(factor: float) -> float:
    """1, 2 or 5 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(factor))
    return float(power * max(step for step in (1, 2, 5) if step * power <= factor * 1.000001))


def _zone(surface: BodySurface) -> Array | None:
    """The neighbourhood of what touches, if it is small in the body."""
    on_contact = surface.fields["status"] >= 0
    if not on_contact.any():
        return None
    closed = surface.fields["status"][on_contact] > 0
    low, high = neighbourhood(surface.points[on_contact], closed)
    if (high - low).max() >= _NEAR * np.ptp(surface.points, axis=0).max():
        return None
    return np.array([low, high])


def steps_shown(steps: int, body: UnstructuredGrid, model: Model) -> list[int]:
    """Numbers of the load steps before the last one that a page has room for, evenly spread.

    Args:
        steps: Of which there are fields.
        body: The grid.
        model: Of the run.
    """
    kinematics = model.kinematics
    points = _MOST_POINTS if kinematics == "axisymmetric" else min(body.n_points, _MOST_POINTS)
    of_step = _BYTES_OF_A_POINT * points + _BYTES_OF_A_CONTACT_POINT * model.contact_points
    most = max(int(_MOST_BYTES // of_step), 2)
    found: list[int] = frame_numbers(steps, most).tolist()
    return found[:-1]
