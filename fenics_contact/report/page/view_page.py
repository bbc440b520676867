"""The interactive view as a part of a page, and the slider through its load steps."""

from __future__ import annotations

import base64
import gzip
import json
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.report.bodies.surface import boundary
from fenics_contact.report.bodies.view_3d import View
from fenics_contact.report.contacts.film import frame_rows
from fenics_contact.report.contacts.moving import MovingContact, moving_curves, moving_maps
from fenics_contact.report.drawing.cells import nodes_at
from fenics_contact.report.drawing.figures import style
from fenics_contact.report.drawing.picture import Picture, numbers
from fenics_contact.report.drawing.style import COLOUR_MAP, ends_of_colours, unit_of
from fenics_contact.report.page.templates import data_uri, file_text, render
from fenics_contact.results.contact_points import BODY_OF_CELLS, ContactTable
from fenics_contact.results.load_history import History
from fenics_contact.results.records.run import Outcome

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid

_MOST_LINES = 60_000  # pieces of cells' sides
_MEASURED = {
    "displacement": "length",
    "temperature": "temperature",
    **dict.fromkeys(("von Mises stress", "contact pressure", "friction traction"), "stress"),
}


def view_html(view: View) -> Markup:
    """The part of a page that holds the view, with all it needs; plotly's script is in it."""
    from plotly.offline import get_plotlyjs

    data = json.dumps(_data(view), ensure_ascii=False, allow_nan=False)
    return Markup(
        render(
            "view.html",
            buttons=_buttons(view),
            label=f"Interactive view of the body, coloured by {', '.join(view.shown)} or contact "
            "status.",
            help=_help(view),
            data=Markup(packed(data)),
            plotly=Markup(packed(get_plotlyjs())),
            script=file_text("view_3d.js"),
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
    least, top = 0.0 if low < 0.05 * high else low, max(float(most if peaked else high), 0.0)
    if name == "temperature":  # of no zero
        least, top = low, float(high)
    first, top = ends_of_colours(least, top)
    return {
        "name": name,
        "symbol": symbol,
        "unit": unit_of(_MEASURED.get(name, "")),
        "values": [_floats(values) for values in _lighter(steps)],
        "low": first,
        "high": top,
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


# Of the step in pictures over all of them: unlike what they are drawn in.
_MARKER = "#b03a2e"
# Pictures of what does not change with the load steps.
_OF_NO_STEP = ("mesh.png",)


class ContactSteps:
    """Contacts of a run in the load steps of a page, taken from its fields as these are read.

    Args:
        result: The content of ``result.json``.
        table: That of ``contact.csv``.
    """

    def __init__(self, result: Outcome, table: ContactTable) -> None:
        self._contacts = [(table.of(contact.name), contact) for contact in result.contacts]
        self._frames: list[list[ContactTable]] = [[] for _ in self._contacts]

    def watched(
        self, series: Iterable[tuple[float, UnstructuredGrid]]
    ) -> Iterator[tuple[float, UnstructuredGrid]]:
        """A series of fields, of which the contacts are kept.

        Args:
            series: Pseudo-times of the steps before the last one, and the body with their fields.
        """
        for time, body in series:
            for frames, (rows, contact) in zip(self._frames, self._contacts, strict=True):
                frames.append(frame_rows(rows, body, contact))
            yield time, body

    def contacts(self, body: UnstructuredGrid) -> list[MovingContact]:
        """All contacts, with the last step as ``contact.csv`` has it.

        Args:
            body: A pyvista grid with the last fields.
        """
        return [
            MovingContact(contact, [*frames, nodes_at(body, rows, contact)[0]], body)
            for frames, (rows, contact) in zip(self._frames, self._contacts, strict=True)
        ]


def slider_html(times: Sequence[float], followers: dict[str, Any] | None = None) -> Markup:
    """The slider, with all that follows it; nothing where there is one step.

    Args:
        times: Pseudo-times of the load steps that it goes through.
        followers: As ``followers`` makes it.
    """
    if len(times) < 2:
        return Markup()
    data = json.dumps(followers, ensure_ascii=False, allow_nan=False) if followers else ""
    return Markup(
        render(
            "slider.html",
            last_step=len(times) - 1,
            data=Markup(packed(data)) if data else Markup(),
            script=file_text("steps.js"),
        )
    )


def followers(
    contacts: Sequence[MovingContact],
    axes: str,
    pictures: Sequence[Picture],
    times: Sequence[float],
    result: Outcome,
) -> dict[str, Any]:
    """Return the drawings that follow the slider: curves, maps, and marks of the step.

    Args:
        contacts: Of the run.
        axes: Letters of its axes.
        pictures: That were drawn of it.
        times: Pseudo-times of the load steps that the slider goes through.
        result: The content of ``result.json``, without steps that have no answer.
    """
    import matplotlib

    colours = (255 * matplotlib.colormaps[COLOUR_MAP](np.arange(256))[:, :3]).round().astype(int)
    drawn = {picture.path.name for picture in pictures}
    found = [
        *(one for one in _contacts(contacts, axes) if one["file"] in drawn),
        *_histories(pictures, times, History.of(result).time),
    ]
    follows = {one["file"] for one in found}
    stills = {name for name in drawn - follows if name.endswith(".png")}
    return {
        "pictures": found,
        "ofTheEnd": sorted(stills - set(_OF_NO_STEP)),
        "colours": ["#{:02x}{:02x}{:02x}".format(*colour) for colour in colours.tolist()],
        "marker": _MARKER,
    }


def _contacts(contacts: Sequence[MovingContact], axes: str) -> Iterator[dict[str, Any]]:
    from matplotlib.colors import to_hex

    with tempfile.TemporaryDirectory() as folder, style():
        for number, moving in enumerate(contacts):
            if not len(moving.frames[-1].status):  # none of its points is a node
                continue
            name = f"contact_{number}.png"
            path = Path(folder) / name
            if axes == "xyz":
                frame, layers = moving_maps(moving, path)
            else:
                frame, layers = moving_curves(moving, axes, path)
            panels = zip(frame.panels, layers, strict=True)
            kinds = [
                {
                    "colour": kind.colour,
                    "edge": to_hex(kind.look["markeredgecolor"]),
                    "shape": kind.shape,
                    "filled": kind.filled,
                }
                for kind in moving.kinds
            ]
            yield {
                "file": name,
                "frame": data_uri(path),
                "width": frame.width,
                "kinds": kinds,
                "panels": [{**panel.as_dict(), "layers": own} for panel, own in panels],
            }


def _histories(
    pictures: Sequence[Picture], times: Sequence[float], known: Array
) -> Iterator[dict[str, Any]]:
    """Pictures over the load steps: where each step of the slider is."""
    steps = np.abs(known[:, None] - np.array(times)).argmin(axis=0)
    for picture in pictures:
        if picture.followed is None:
            continue
        frame, panels = picture.followed.frame, []
        for panel, (x, y) in zip(frame.panels, picture.followed.places, strict=True):
            layer: dict[str, Any] = {"type": "time", "x": numbers(x[steps], 6)}
            if y is not None:
                layer |= {"type": "dot", "y": numbers(y[steps], 6)}
            panels.append({**panel.as_dict(), "layers": [layer]})
        yield {"file": picture.path.name, "width": frame.width, "panels": panels}
