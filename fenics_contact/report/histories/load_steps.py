"""Curves over the load steps: forces, force against displacement, areas, energies."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.quantities.names import (
    CONTACT_AREA,
    DAMPING_WORK,
    ELASTIC_SLIP_ENERGY,
    ENERGY_DEFECT,
    EXTERNAL_WORK,
    FRICTION_FORCE,
    FRICTION_WORK,
    KINETIC_ENERGY,
    NORMAL_FORCE,
    PENALTY_ENERGY,
    PRESSURE_INTEGRAL,
    STICK_AREA,
    STRAIN_ENERGY,
)
from fenics_contact.report.drawing.figures import (
    legend_beside,
    legend_in_headroom,
    new_figure,
    plain,
    save,
    set_title,
)
from fenics_contact.report.drawing.frames import frame_of
from fenics_contact.report.drawing.picture import Followed, Picture
from fenics_contact.report.drawing.style import COLOURS, COLUMN, DOUBLE, LINES, WIDE
from fenics_contact.report.drawing.units import labelled, with_unit
from fenics_contact.report.histories.hysteresis import Loop, last_loop
from fenics_contact.results.load_history import Drive, History
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.run import Outcome

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_HEIGHT, _MARGIN = 1.6, 0.45
_MOST_DRIVES = 6
# A component is drawn from this share of the largest on.
_SHOWN = 0.01
_MANY = 60


def draw_history(folder: Path, result: Outcome, far: tuple[str, ...] = ()) -> list[Picture]:
    """Draw ``history_*.png`` of a run with several load steps.

    Args:
        folder: Where to.
        result: The content of its ``result.json``.
        far: Names of supports that are no drives: they move as a half-space does.
    """
    history = History.of(result)
    if len(history.steps) < 2:
        return []
    contacts = result.contacts
    drives = history.drives(contacts, far)[:_MOST_DRIVES]
    drawn = [_loops(history, drives, folder / "history_loops.png")] if drives else []
    if contacts:
        drawn.append(draw_forces(history, contacts, folder / "history_forces.png"))
        drawn.append(_areas(history, contacts, folder / "history_areas.png"))
    return [*drawn, _energies(history, folder / "history_energy.png")]


def time_label(clock: str) -> str:
    """Return the label of an axis of times; pseudo-time has no unit.

    Args:
        clock: As of ``History``.
    """
    return labelled("time, $t$", "time") if clock == "time" else f"{clock}, $t$"


def over_time(title: str, heights: list[float], history: History) -> tuple[Figure, list[Axes]]:
    """A figure of panels over the pseudo-time, one below the other.

    Args:
        title: Of the first.
        heights: Of each (inches).
        history: Of the run.
    """
    figure, panels = new_figure(
        title,
        (WIDE, sum(heights) + _MARGIN),
        nrows=len(heights),
        sharex=True,
        height_ratios=heights,
    )
    panels[-1].set_xlabel(time_label(history.clock))
    first, second, *_ = history.time
    panels[-1].set_xlim(max(0, 2 * first - second), 1.03 * history.time[-1])
    return figure, panels


def line(panel: Axes, x: Array, y: Array, label: str, number: int) -> None:
    """Draw one of several curves, told apart by colour and dashes.

    Args:
        panel: Matplotlib's axes.
        x: To the right, (points,).
        y: Upwards, likewise.
        label: Of the legend.
        number: Of the curve, from 0.
    """
    colour, dashes = LINES[number % len(LINES)]
    mark = "." if len(x) <= _MANY else ""
    panel.plot(x, y, linestyle=dashes, color=colour, marker=mark, label=label)


def _legend(panel: Axes) -> None:
    panel.axhline(0, color="black", linewidth=0.5, zorder=0)
    if len(panel.get_legend_handles_labels()[1]) > 1:
        legend_beside(panel)


def draw_forces(history: History, contacts: list[ContactRecord], path: Path) -> Picture:
    """Draw normal forces, and below them what friction gives, one curve an axis that counts.

    Args:
        history: Of the run.
        contacts: Of ``result.json``.
        path: PNG file to write.
    """
    friction = list(_friction_curves(history, contacts))
    heights = [_HEIGHT] * (2 if friction else 1)
    figure, panels = over_time("Forces on the body", heights, history)
    wraps = False
    for number, contact in enumerate(contacts):
        normal, around = history.of_contact(number, NORMAL_FORCE), r""
        if normal is None:  # the surface wraps around
            normal, around = history.of_contact(number, PRESSURE_INTEGRAL), r", $\int p\,dA$"
        if normal is not None:
            wraps |= bool(around)
            line(panels[0], history.time, normal, plain(f"'{contact.name}'") + around, number)
    panels[0].set_ylabel(labelled("normal force, $P$", "force"))
    if wraps and len(contacts) == 1:
        panels[0].set_ylabel(labelled(r"pressure integral, $\int p\,dA$", "force"))
    for number, (label, values) in enumerate(friction):
        line(panels[1], history.time, values, label, number)
    if friction:
        panels[1].set_ylabel(labelled("friction force, $Q$", "force"))
        if len(friction) == 1:
            symbol = friction[0][0].split(", ")[-1]
            panels[1].set_ylabel(labelled(f"friction force, {symbol}", "force"))
    for panel in panels:
        _legend(panel)
    figure.align_ylabels(panels)
    save(figure, path)
    said = "Normal force P" + (" and friction force Q" if friction else "")
    said = f"{said} on the body over the {history.clock} t."
    if wraps:
        said += " Where a surface wraps around, ∫ p dA stands for the normal force."
    return Picture(path, "Forces on the body", said, followed(figure, panels, history))


def _friction_curves(
    history: History, contacts: list[ContactRecord]
) -> Iterator[tuple[str, Array]]:
    """Label and values of the components of friction forces that are not next to nothing."""
    found = [history.of_contact(number, FRICTION_FORCE) for number in range(len(contacts))]
    largest = max((float(np.abs(f).max()) for f in found if f is not None), default=0.0)
    for contact, forces in zip(contacts, found, strict=True):
        if not contact.carries_shear or forces is None or largest == 0:
            continue
        for axis, values in zip("xyz", forces.T, strict=False):
            if np.abs(values).max() > _SHOWN * largest:
                yield plain(f"'{contact.name}'") + f", $Q_{axis}$", values


def _areas(history: History, contacts: list[ContactRecord], path: Path) -> Picture:
    """In contact, and the part of it that sticks, one panel a contact."""
    figure, panels = over_time("Areas in contact", [_HEIGHT] * len(contacts), history)
    for number, (contact, panel) in enumerate(zip(contacts, panels, strict=True)):
        closed = history.of_contact(number, CONTACT_AREA)
        sticks = history.of_contact(number, STICK_AREA)
        assert closed is not None and sticks is not None
        rough = contact.carries_shear
        colour, label = ("SLIP", "slip") if rough else ("STICK", "in contact")
        panel.fill_between(history.time, closed, color=COLOURS[colour], lw=0, label=label)
        if rough:
            panel.fill_between(history.time, sticks, color=COLOURS["STICK"], lw=0, label="stick")
        panel.plot(history.time, closed, color="black", linewidth=0.8)
        panel.set_ylim(0, 1.3 * closed.max() or 1)
        panel.set_ylabel(labelled("area, $A$", "area"))
        if len(contacts) > 1:
            panel.annotate(
                plain(f"'{contact.name}'"), (0.99, 0.97), va="top", ha="right",
                xycoords="axes fraction",
            )  # fmt: skip
        panel.legend(loc="upper left", ncols=2)
    save(figure, path)
    said = f"Area in contact over the {history.clock} t"
    if any(contact.carries_shear for contact in contacts):
        said += ", and the parts of it that stick and slip"
    return Picture(path, "Areas in contact", said + ".", followed(figure, panels, history))


def _energies(history: History, path: Path) -> Picture:
    """Work and where it went; below, what does not balance."""
    names = {
        EXTERNAL_WORK: "work done, $W$",
        KINETIC_ENERGY: "kinetic energy, $T$",
        STRAIN_ENERGY: "strain energy, $E$",
        FRICTION_WORK: "dissipated, $D$",
        DAMPING_WORK: "taken by damping, $D_v$",
        PENALTY_ENERGY: "in springs of contacts, $E_p$",
        ELASTIC_SLIP_ENERGY: "in elastic slip, $E_s$",
    }
    known = history.steps[0].quantities
    names = {name: label for name, label in names.items() if known.get(name) is not None}
    largest = max(np.abs(history.quantity(name)).max() for name in names)
    balances = ENERGY_DEFECT in known
    figure, panels = over_time("Work and energies", [2.1, 1.1][: 1 + balances], history)
    for number, (name, label) in enumerate(names.items()):
        values = history.quantity(name)
        least = 0.0 if name == FRICTION_WORK else _SHOWN * largest
        if np.abs(values).max() > least:
            line(panels[0], history.time, values, label, number)
    panels[0].set_ylabel(labelled("energy", "energy"))
    if balances:
        line(panels[1], history.time, history.quantity(ENERGY_DEFECT), "", 0)
        sprung = " - E_s" if ELASTIC_SLIP_ENERGY in known else ""
        brought, moving = ("T_0 + W", " - T$\n$") if KINETIC_ENERGY in known else ("W", "")
        damped = " - D_v" if DAMPING_WORK in known else ""
        balance = f"${brought}{moving} - E - E_p{sprung} - D{damped}$"
        panels[1].set_ylabel(labelled(balance, "energy"))
    for panel in panels:
        _legend(panel)
    figure.align_ylabels(panels)
    save(figure, path)
    done = "Work W of loads and obstacles, strain" if EXTERNAL_WORK in names else "Strain"
    said = f"{done} energy E and what friction has dissipated, D"
    said += "; below, what does not balance, which load steps leave." if balances else "."
    return Picture(path, "Work and energies", said, followed(figure, panels, history))


def followed(figure: Figure, panels: list[Axes], history: History) -> Followed:
    """Where the steps are: each at its pseudo-time.

    Args:
        figure: Of the panels.
        panels: All of them.
        history: Of the run.
    """
    return Followed(frame_of(figure, panels), [(history.time, None) for _ in panels])


def _loops(history: History, drives: list[Drive], path: Path) -> Picture:
    """Force against displacement, one panel each, with arrows along the path."""
    loops = [last_loop(drive.x, drive.y) for drive in drives]
    shown: list[tuple[Drive, Loop | None, bool]] = []
    for drive, loop in zip(drives, loops, strict=True):
        shown.append((drive, loop, False))
        if loop is not None and loop.is_thin:
            shown.append((drive, loop, True))
    columns = min(len(shown), 2)
    rows = -(-len(shown) // columns)
    size = (DOUBLE if columns > 1 else COLUMN + 0.4, 2.7 * rows + 0.2)
    figure, panels = new_figure("", size, nrows=rows, ncols=columns)
    paths = [
        _loop(panel, drive, loop, is_sheared)
        for (drive, loop, is_sheared), panel in zip(shown, panels, strict=False)
    ]
    for panel in panels[len(shown) :]:
        panel.set_axis_off()
    save(figure, path)
    said = "Force against displacement; arrows follow the path, the dot is its end."
    if any(loops):
        work = "the energy that it dissipates" if _dissipates(history, loops) else "> 0 if put in"
        said += f" Shaded: the last closed loop; ΔW is the work of this drive over it, {work}."
    if any(is_sheared for *_, is_sheared in shown):
        said += " Beside it the same less the straight line C F between its turning points."
    places = Followed(frame_of(figure, panels[: len(paths)]), [(p.x, p.y) for p in paths])
    return Picture(path, "Force against displacement", said, places)


def _dissipates(history: History, loops: list[Loop | None]) -> bool:
    """Whether the work of the only drive over a loop is all work that is done meanwhile."""
    if len(loops) != 1 or loops[0] is None:
        return False
    loop = loops[0]
    done = history.quantity(EXTERNAL_WORK)
    return bool(abs(done[loop.last] - done[loop.first] - loop.work) < _SHOWN * abs(loop.work))


def _loop(panel: Axes, drive: Drive, loop: Loop | None, is_sheared: bool) -> Drive:
    """Draw a path with its last closed loop; sheared so that a thin one opens."""
    moved = drive.x - (loop.compliance * drive.y if loop and is_sheared else 0.0)
    path = Drive(drive.title, drive.moved, drive.force, moved, drive.y)
    if loop is not None:
        inside = slice(loop.first, loop.last + 1)
        words = with_unit(rf"$\Delta W = {_number(loop.work)}$", "energy")
        panel.fill(moved[inside], drive.y[inside], color=COLOURS["OPEN"], lw=0, label=words)
    line(panel, path.x, path.y, "", 0)
    _arrows(panel, path)
    panel.plot(*(path.x[-1:], path.y[-1:]), "o", color=COLOURS["SLIP"], markersize=5, zorder=4)
    panel.axhline(0, color="black", linewidth=0.5, zorder=0)
    panel.locator_params(axis="x", nbins=6)
    symbol, force = (words.split(", ")[-1].strip("$") for words in (drive.moved, drive.force))
    panel.set_xlabel(
        labelled(
            f"elastic part left out, ${symbol} - C\\,{force}$" if is_sheared else drive.moved,
            "length",
        )
    )
    panel.set_ylabel(labelled(drive.force, "force"))
    set_title(panel, drive.title[0].upper() + drive.title[1:])
    if loop is not None and not is_sheared:
        legend_in_headroom(panel)
    return path


def _number(value: float) -> str:
    """With four digits, for mathtext."""
    mantissa, _, power = f"{value:.4g}".partition("e")
    return mantissa + (rf"\times 10^{{{int(power)}}}" if power else "")


def _arrows(panel: Axes, drive: Drive) -> None:
    """Draw the direction of a path at a few places along it."""
    x, y = (values / (np.ptp(values) or 1.0) for values in (drive.x, drive.y))
    lengths = np.hypot(np.diff(x), np.diff(y))
    reached = np.cumsum(lengths)
    for share in (0.15, 0.35, 0.55, 0.75, 0.95):
        i = int(np.searchsorted(reached, share * reached[-1]))
        start, end = (drive.x[i], drive.y[i]), (drive.x[i + 1], drive.y[i + 1])
        middle = tuple(0.5 * (a + b) for a, b in zip(start, end, strict=True))
        look = {"arrowstyle": "-|>", "color": COLOURS["STICK"], "lw": 0, "mutation_scale": 9}
        panel.annotate("", middle, start, arrowprops=look)
