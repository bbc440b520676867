"""The slider of a page that goes through the load steps, and what follows it beside the view."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup

from fenics_contact.common.arrays import Array
from fenics_contact.report.contacts.film import frame_rows
from fenics_contact.report.contacts.moving import MovingContact, moving_curves, moving_maps
from fenics_contact.report.drawing.facets import nodes_at
from fenics_contact.report.drawing.figures import style
from fenics_contact.report.drawing.frames import numbers
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import COLOUR_MAP
from fenics_contact.report.page.templates import data_uri, render
from fenics_contact.report.view.view_page import packed
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.load_history import History
from fenics_contact.results.records.run import Outcome

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid

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
    script = resources.files(__package__).joinpath("steps.js").read_text(encoding="utf-8")
    return Markup(
        render(
            "slider.html",
            last_step=len(times) - 1,
            data=Markup(packed(data)) if data else Markup(),
            script=Markup(script),
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
