"""Text on a terminal: only rich itself moves the cursor and sets colours."""

from __future__ import annotations

import logging
from collections.abc import Iterable

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment

from fenics_contact.common.wording import printable


class Terminal(Console):
    """A console of rich whose texts are printable."""

    def widen(self, width: int) -> None:
        """Have lines of at least this many characters."""
        self.width = max(self.width, width)

    def be_quiet(self, quiet: bool) -> None:
        """Say nothing from now on, or say it again."""
        self.quiet = quiet

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """As rich does, with texts printable.

        Args:
            renderable: What is shown.
            options: Of rich.
        """
        for segment in super().render(renderable, options):
            yield segment if segment.control else segment._replace(text=printable(segment.text))


class PlainFormatter(logging.Formatter):
    """Messages of logging as they are, printable."""

    def format(self, record: logging.LogRecord) -> str:
        """The message of a record.

        Args:
            record: Of logging.
        """
        return printable(super().format(record))
