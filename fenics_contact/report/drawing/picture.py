"""A picture that was drawn from a run, and what it shows."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from fenics_contact.common.arrays import Array
from fenics_contact.report.drawing.frames import Frame

__all__ = ["Followed", "Picture"]


@dataclass(frozen=True)
class Followed:
    """Where the load steps are in a picture over all of them.

    Attributes:
        frame: Its panels.
        places: Of each panel the numbers of all steps that have an answer, to the right and
            upwards, (steps,) each; None for the second where a step is a line across the panel.
    """

    frame: Frame
    places: list[tuple[Array, Array | None]]


@dataclass(frozen=True)
class Picture:
    """A picture or an animation, with the words that go with it.

    Attributes:
        path: The file.
        title: What it shows, in a few words of plain text.
        caption: What is seen in it, with its symbols: one or two sentences of plain text.
        followed: Where the load steps are in it, if it is over them.
    """

    path: Path
    title: str
    caption: str
    followed: Followed | None = None
