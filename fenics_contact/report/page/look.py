"""One HTML file that shows bodies and surfaces, and needs nothing else to be shown."""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np
from markupsafe import Markup

from fenics_contact.common.arrays import Array
from fenics_contact.common.wording import one_line
from fenics_contact.report.page.templates import file_text, render, style_sheet


@dataclass(frozen=True)
class BodyRow:
    """A body as people read of it.

    Attributes:
        number: On the page.
        name: Of the file.
        measure: Its volume or area.
    """

    number: int
    name: str
    measure: str


@dataclass(frozen=True)
class SurfaceRow:
    """A surface as people read of it.

    Attributes:
        called: Its number or name, as scenes take it.
        names: Of the groups that hold it.
        bodies: Indices of the bodies that it bounds.
        kind: What it is, such as a cylinder.
        measure: Its area or length.
        place: Where it is.
        at: Where its number stands, a little before it (length).
    """

    called: str
    names: str
    bodies: tuple[int, ...]
    kind: str
    measure: str
    place: str
    at: tuple[float, ...]


@dataclass(frozen=True)
class PairRow:
    """Surfaces that face each other.

    Attributes:
        name: Of the contact that is proposed.
        surfaces: Their indices.
        sides: What they are called, of each body.
        words: How far apart they are.
    """

    name: str
    surfaces: tuple[int, ...]
    sides: tuple[str, str]
    words: str


@dataclass(frozen=True)
class PlaceRow:
    """Points, or edges in space, as people read of them.

    Attributes:
        called: As scenes name them in quotation marks.
        length: Of edges.
        place: Where they are.
        pieces: Begin and end of straight pieces, the same of points (length).
    """

    called: str
    length: str
    place: str
    pieces: tuple[tuple[tuple[float, ...], tuple[float, ...]], ...]


@dataclass(frozen=True)
class Look:
    """Content of the page on a mesh.

    Attributes:
        title: Its heading.
        dimension: 2 or 3.
        bodies: In order.
        surfaces: In order.
        pairs: In order.
        relations: How the bodies lie, and what looks wrong in the file, in sentences.
        scene: The text of the scene that is proposed.
        commands: That come next.
        cells: Of the mesh that is shown.
        places: Points and edges that supports may hold, in order.
    """

    title: str
    dimension: int
    bodies: Sequence[BodyRow]
    surfaces: Sequence[SurfaceRow]
    pairs: Sequence[PairRow]
    relations: Sequence[str]
    scene: str
    commands: Sequence[str]
    cells: int
    places: Sequence[PlaceRow] = ()


def look_page(look: Look, triangles: Sequence[Array], rest: Array) -> str:
    """The whole page; plotly's script is in it.

    Args:
        look: What is said.
        triangles: Of every surface, (triangles, 3, 3) (length).
        rest: Those that are of no surface.
    """
    from plotly.offline import get_plotlyjs

    data = {
        "flat": look.dimension == 2,
        "bodies": [asdict(body) for body in look.bodies],
        "surfaces": [
            {key: _plain(value) for key, value in asdict(row).items()} | {"points": _packed(drawn)}
            for row, drawn in zip(look.surfaces, triangles, strict=True)
        ],
        "pairs": [list(pair.surfaces) for pair in look.pairs],
        "rest": _packed(rest),
        "places": [{"called": one_line(row.called), "pieces": row.pieces} for row in look.places],
    }
    text = json.dumps(data, allow_nan=False).replace("<", "\\u003c")
    return render(
        "look.html",
        look=look,
        one_line=one_line,
        data=Markup(text),
        style=style_sheet(),
        plotly=Markup(get_plotlyjs()),
        script=file_text("look.js"),
    )


def _plain(value: object) -> object:
    return one_line(value) if isinstance(value, str) else value


def _packed(triangles: Array) -> str:
    """Corners one after the other, as 32-bit floats in base64."""
    return base64.b64encode(np.asarray(triangles, dtype="<f4").tobytes()).decode("ascii")
