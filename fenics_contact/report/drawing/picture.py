"""A picture that was drawn from a run, and what it shows."""

from dataclasses import dataclass
from pathlib import Path

__all__ = ["Picture"]


@dataclass(frozen=True)
class Picture:
    """A picture or an animation, with the words that go with it.

    Attributes:
        path: The file.
        title: What it shows, in a few words of plain text.
        caption: What is seen in it, with its symbols: one or two sentences of plain text.
    """

    path: Path
    title: str
    caption: str
