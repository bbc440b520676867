"""Matplotlib figures of panels that look alike."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fenics_contact.writing import replaced_file


def new_figure(title: str, size: tuple[float, float], **panels: Any) -> tuple[Any, list[Any]]:
    """A figure and its panels.

    Args:
        title: Of the figure, any text.
        size: Width and height in inches.
        **panels: For matplotlib's ``subplots``.
    """
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=size, layout="constrained", squeeze=False, **panels)
    for panel in axes.flat:
        panel.spines[["top", "right"]].set_visible(False)
    axes[0, 0].set_title(title.replace("$", r"\$"), loc="left", fontsize=11)
    return figure, list(axes.flat)


def save(figure: Any, path: Path) -> None:
    """Write a figure and let it go."""
    import matplotlib.pyplot as plt

    try:
        with replaced_file(path) as temporary:
            figure.savefig(temporary, dpi=150)
    finally:
        plt.close(figure)


def surface_of(contact: dict[str, Any]) -> str:
    """The surface that a contact of ``result.json`` is of, and the one opposite, in words."""
    if "master" in contact:
        return f"'{contact['slave']}' against '{contact['master']}'"
    return f"'{contact['name']}'"


def title_of(panels: list[str], contact: dict[str, Any]) -> str:
    """Such as: Contact pressure and gap on 'top'."""
    words = " and ".join([", ".join(panels[:-1]), panels[-1]] if len(panels) > 1 else panels)
    return f"{words[0].upper()}{words[1:]} on {surface_of(contact)}"
