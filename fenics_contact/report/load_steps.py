"""Curves over the load steps: forces, areas, energies, bolts, and wear."""

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
    MAX_WEAR_DEPTH,
    NORMAL_FORCE,
    PENALTY_ENERGY,
    PRESSURE_INTEGRAL,
    SPRING_ENERGY,
    STICK_AREA,
    STRAIN_ENERGY,
    WORN_VOLUME,
)
from fenics_contact.report.drawing.figures import (
    legend_beside,
    line,
    new_figure,
    plain,
    save,
)
from fenics_contact.report.drawing.picture import Followed, Picture, frame_of
from fenics_contact.report.drawing.style import (
    COLOURS,
    WIDE,
    labelled,
)
from fenics_contact.report.hysteresis import draw_loops
from fenics_contact.results.load_history import History
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.run import Outcome

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_HEIGHT, _MARGIN = 1.6, 0.45
_MOST_DRIVES = 6
# A component is drawn from this share of the largest on.
_SHOWN = 0.01


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
    drawn = [draw_loops(history, drives, folder / "history_loops.png")] if drives else []
    if contacts:
        drawn.append(draw_forces(history, contacts, folder / "history_forces.png"))
        drawn.append(_areas(history, contacts, folder / "history_areas.png"))
    if history.steps[-1].preloads:
        drawn.append(_bolts(history, folder / "history_bolts.png"))
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


def _bolts(history: History, path: Path) -> Picture:
    """Force of each preloaded part, with a line where the length of one is locked."""
    figure, (panel,) = over_time("Forces of preloaded parts", [2.1], history)
    names, starts = list(history.steps[-1].preloads), set[float]()
    for number, name in enumerate(names):
        found = [step.preloads[name] for step in history.steps]
        forces = np.array([one.force for one in found])
        line(panel, history.time, forces, plain(f"'{name}'"), number)
        locked = [n for n, one in enumerate(found) if one.locked and n > 0]
        starts |= {float(history.time[n - 1]) for n in locked[:1]}
    for start in sorted(starts):
        panel.axvline(start, color="0.6", linewidth=0.8, linestyle=":", zorder=0)
    panel.set_ylabel(labelled("force, $F$", "force"))
    if len(names) > 1:
        legend_beside(panel)
    save(figure, path)
    said = f"Force along each preloaded part over the {history.clock} t"
    said += "; a dotted line where the length of one is locked." if starts else "."
    title = "Forces of preloaded parts"
    return Picture(path, title, said, followed(figure, [panel], history))


def _energies(history: History, path: Path) -> Picture:
    """Work and where it went; below, what does not balance."""
    names = {
        EXTERNAL_WORK: "work done, $W$",
        KINETIC_ENERGY: "kinetic energy, $T$",
        STRAIN_ENERGY: "strain energy, $E$",
        FRICTION_WORK: "dissipated, $D$",
        DAMPING_WORK: "taken by damping, $D_v$",
        PENALTY_ENERGY: "in springs of contacts, $E_p$",
        SPRING_ENERGY: "in springs, $E_k$",
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
        sprung = (" - E_k" if SPRING_ENERGY in known else "") + sprung
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
    """Where the steps are: each at its pseudo-time."""
    return Followed(frame_of(figure, panels), [(history.time, None) for _ in panels])


_OF_WEAR = {
    WORN_VOLUME: ("worn volume, $V$", "volume"),
    MAX_WEAR_DEPTH: ("deepest wear, $h$", "length"),
}


def draw_worn_history(folder: Path, result: Outcome) -> list[Picture]:
    """Draw ``history_wear.png`` of a run with several load steps whose contacts wear.

    Args:
        folder: Where to.
        result: The content of its ``result.json``.
    """
    history = History.of(result)
    found = {
        contact.name: {name: history.of_contact(number, name) for name in _OF_WEAR}
        for number, contact in enumerate(result.contacts)
    }
    worn = {name: values for name, values in found.items() if values[WORN_VOLUME] is not None}
    if len(history.steps) < 2 or not worn:
        return []
    figure, panels = over_time("Wear", [_HEIGHT] * len(_OF_WEAR), history)
    for panel, (name, (words, unit)) in zip(panels, _OF_WEAR.items(), strict=True):
        for number, (contact, values) in enumerate(worn.items()):
            curve = values[name]
            assert curve is not None
            line(panel, history.time, np.asarray(curve), plain(f"'{contact}'"), number)
        panel.set_ylabel(labelled(words, unit))
        panel.set_ylim(bottom=0)
        if len(worn) > 1:
            legend_beside(panel)
    figure.align_ylabels(panels)
    path = folder / "history_wear.png"
    save(figure, path)
    said = "Worn volume V and deepest wear h, of both surfaces together, over the pseudo-time t."
    return [Picture(path, "Wear", said, followed(figure, panels, history))]
