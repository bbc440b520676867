"""Curves over the load steps: forces, force against displacement, areas, energies."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.figures import new_figure, save
from fenics_contact.history import Drive, History
from fenics_contact.picture_style import COLOURS, LINES

Array = NDArray[np.float64]

_WIDTH, _HEIGHT, _MARGIN = 7.2, 2.6, 0.6
_MOST_DRIVES = 6
# A component is drawn from this share of the largest on.
_SHOWN = 0.01
_MANY = 60


def draw_history(folder: Path, result: dict[str, Any]) -> list[Path]:
    """Draw ``history_*.png`` of a run with several load steps.

    Args:
        folder: Where to.
        result: The content of its ``result.json``.

    Returns:
        The files drawn.
    """
    history = History.of(result)
    if len(history.steps) < 2:
        return []
    contacts = result["contacts"]
    drawn = [_energies(history, folder / "history_energy.png")]
    if contacts:
        drawn.append(_forces(history, contacts, folder / "history_forces.png"))
        drawn.append(_areas(history, contacts, folder / "history_areas.png"))
    drives = history.drives(contacts)[:_MOST_DRIVES]
    return drawn + ([_loops(drives, folder / "history_loops.png")] if drives else [])


def _over_time(title: str, heights: list[float], history: History) -> tuple[Any, list[Any]]:
    figure, panels = new_figure(
        title,
        (_WIDTH, sum(heights) + _MARGIN),
        nrows=len(heights),
        sharex=True,
        height_ratios=heights,
    )
    panels[-1].set_xlabel("pseudo-time, $t$")
    first, second, *_ = history.time
    panels[-1].set_xlim(max(0, 2 * first - second), 1.03 * history.time[-1])
    return figure, panels


def _line(panel: Any, x: Array, y: Array, label: str, number: int) -> None:
    """One of several curves, told apart by colour and dashes."""
    colour, dashes = LINES[number % len(LINES)]
    mark = "." if len(x) <= _MANY else ""
    panel.plot(x, y, dashes, color=colour, linewidth=1.4, marker=mark, markersize=5, label=label)


def _legend(panel: Any) -> None:
    panel.axhline(0, color="black", linewidth=0.6)
    if len(panel.get_legend_handles_labels()[1]) > 1:
        panel.legend(frameon=False, fontsize=9)


def _forces(history: History, contacts: list[dict[str, Any]], path: Path) -> Path:
    """Normal forces, and below them what friction gives, one curve an axis that counts."""
    friction = list(_friction_curves(history, contacts))
    heights = [_HEIGHT] * (2 if friction else 1)
    figure, panels = _over_time("Forces on the body", heights, history)
    for number, contact in enumerate(contacts):
        normal = history.of_contact(number, "normal_force")
        assert normal is not None
        _line(panels[0], history.time, normal, f"'{contact['name']}'", number)
    panels[0].set_ylabel("normal force, $P$")
    for number, (label, values) in enumerate(friction):
        _line(panels[1], history.time, values, label, number)
    if friction:
        panels[1].set_ylabel("friction force, $Q$")
        if len(friction) == 1:
            panels[1].set_ylabel(f"friction force, {friction[0][0].split(', ')[-1]}")
    for panel in panels:
        _legend(panel)
    save(figure, path)
    return path


def _friction_curves(
    history: History, contacts: list[dict[str, Any]]
) -> Iterator[tuple[str, Array]]:
    """Label and values of the components of friction forces that are not next to nothing."""
    found = [history.of_contact(number, "friction_force") for number in range(len(contacts))]
    largest = max(float(np.abs(f).max()) for f in found if f is not None)
    for contact, forces in zip(contacts, found, strict=True):
        if contact["law"] == "none" or forces is None or largest == 0:
            continue
        for axis, values in zip("xyz", forces.T, strict=False):
            if np.abs(values).max() > _SHOWN * largest:
                yield f"'{contact['name']}', $Q_{axis}$", values


def _areas(history: History, contacts: list[dict[str, Any]], path: Path) -> Path:
    """In contact, and the part of it that sticks, one panel a contact."""
    figure, panels = _over_time("Areas in contact", [2.2] * len(contacts), history)
    for number, (contact, panel) in enumerate(zip(contacts, panels, strict=True)):
        closed = history.of_contact(number, "contact_area")
        sticks = history.of_contact(number, "stick_area")
        assert closed is not None and sticks is not None
        rough = contact["law"] != "none"
        colour, label = ("SLIP", "slip") if rough else ("OPEN", "in contact")
        panel.fill_between(
            history.time, closed, color=COLOURS[colour], alpha=0.5, lw=0, label=label
        )
        if rough:
            panel.fill_between(history.time, sticks, color=COLOURS["STICK"], lw=0, label="stick")
        panel.plot(history.time, closed, color="black", linewidth=1)
        panel.set_ylim(0, 1.3 * closed.max() or 1)
        panel.set_ylabel(f"area of '{contact['name']}'")
        panel.legend(frameon=False, fontsize=9, loc="upper left", ncols=2)
    save(figure, path)
    return path


def _energies(history: History, path: Path) -> Path:
    """Work and where it went; below, what does not balance."""
    names = {
        "external_work": "work done, $W$",
        "strain_energy": "strain energy, $E$",
        "friction_work": "dissipated, $D$",
        "penalty_energy": "in springs of contacts, $E_p$",
    }
    work = np.abs(history.quantity("external_work")).max()
    balances = "energy_defect" in history.steps[0]["quantities"]
    figure, panels = _over_time("Work and energies", [3.2, 1.6][: 1 + balances], history)
    for number, (name, label) in enumerate(names.items()):
        values = history.quantity(name)
        least = 0.0 if name == "friction_work" else _SHOWN * work
        if np.abs(values).max() > least:
            _line(panels[0], history.time, values, label, number)
    panels[0].set_ylabel("energy")
    if balances:
        _line(panels[1], history.time, history.quantity("energy_defect"), "", 0)
        panels[1].set_ylabel("$W - E - E_p - D$")
        panels[1].ticklabel_format(axis="y", style="sci", scilimits=(-2, 3))
    for panel in panels:
        _legend(panel)
    save(figure, path)
    return path


def _loops(drives: list[Drive], path: Path) -> Path:
    """Force against displacement, one panel each, with arrows along the path."""
    columns = min(len(drives), 2)
    rows = -(-len(drives) // columns)
    size = (4.6 * columns + 0.6 * (columns == 1), 3.6 * rows + 0.3)
    figure, panels = new_figure("Force against displacement", size, nrows=rows, ncols=columns)
    for drive, panel in zip(drives, panels, strict=False):
        _line(panel, drive.x, drive.y, "", 0)
        _arrows(panel, drive)
        end = (drive.x[-1:], drive.y[-1:])
        panel.plot(*end, "o", color=COLOURS["SLIP"], markersize=6, label="end")
        panel.locator_params(axis="x", nbins=6)
        panel.legend(frameon=False, fontsize=9, title=drive.title, title_fontsize=9)
        panel.axhline(0, color="black", linewidth=0.6)
        panel.set_xlabel(drive.moved)
        panel.set_ylabel(drive.force)
    for panel in panels[len(drives) :]:
        panel.set_axis_off()
    save(figure, path)
    return path


def _arrows(panel: Any, drive: Drive) -> None:
    """Which way the path goes, at a few places along it."""
    x, y = (values / (np.ptp(values) or 1.0) for values in (drive.x, drive.y))
    lengths = np.hypot(np.diff(x), np.diff(y))
    reached = np.cumsum(lengths)
    for share in (0.15, 0.35, 0.55, 0.75, 0.95):
        i = int(np.searchsorted(reached, share * reached[-1]))
        start, end = (drive.x[i], drive.y[i]), (drive.x[i + 1], drive.y[i + 1])
        middle = tuple(0.5 * (a + b) for a, b in zip(start, end, strict=True))
        look = {"arrowstyle": "-|>", "color": COLOURS["STICK"], "lw": 0, "mutation_scale": 15}
        panel.annotate("", middle, start, arrowprops=look)
