"""Output on the terminal: the model before a run, the numbers and checks after it."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from rich import box
from rich.markup import escape
from rich.table import Table

from fenics_contact.analyses import registry
from fenics_contact.common.terminal import Terminal
from fenics_contact.common.wording import one_line
from fenics_contact.quantities.names import REACTION
from fenics_contact.quantities.table import with_true_value
from fenics_contact.results.check_messages import compares, level_rows, title
from fenics_contact.results.load_history import newton_steps
from fenics_contact.results.quantities import (
    coupling_rows,
    headlines,
    idle_quantities,
    in_figures,
    measured_by_parameter,
    preload_rows,
    quantity_rows,
    reaction_rows,
    secondary_quantities,
)
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.record import UnitsRecord
from fenics_contact.results.records.run import Model, RigidMotion
from fenics_contact.results.result import Check, Result
from fenics_contact.results.tables import branch_rows, motion_words, share_words
from fenics_contact.scene.contact import Contact, Wear
from fenics_contact.scene.given_keys import given_keys
from fenics_contact.scene.loading.cycles import Cycles
from fenics_contact.scene.loading.load_paths import load_steps_in_cycle
from fenics_contact.scene.reference import measured_by
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.units.dimensions import UnitNames

# Keys of the model whose names alone say little.
_IN_WORDS = {
    "dofs": "displacement unknowns",
    "solver_memory_mb": "memory of the solver (MB)",
    "scalar_unknowns": "other unknowns",
    "free_rigid_motions": "motions left to friction",
}
# Those that say something only where there are motions that supports leave to friction.
_OF_FREE_MOTIONS = ("free_rigid_motions", "used_share_of_limit_load")
# Parameters of a contact that come first in its line; those that do not apply are zero or missing.
_PARAMETERS = (
    "pressure",
    "foundation_stiffness",
    "penalty_parameter",
    "friction_coefficient",
    "regularisation_parameter",
    "force",
)


def print_model(
    scene: Scene,
    model: Model,
    groups: str,
    contacts: list[ContactRecord],
    plan: str = "",
    relations: Sequence[str] = (),
    notes: Sequence[str] = (),
) -> None:
    """Say what would be modelled: ``fenics-contact check``.

    Args:
        scene: The scene.
        model: What would be solved, and how.
        groups: Names of the mesh's groups.
        contacts: Of the scene.
        plan: What is said of an accuracy that is asked for.
        relations: How bodies of a geometry lie that are near each other, in words.
        notes: What of the mesh's files is not in the model, or looks wrong.
    """
    console = Terminal()
    table = _table("", "")
    hidden = {"terms", "rigid_motions", *([] if model.free_rigid_motions else _OF_FREE_MOTIONS)}
    for key, value in model.items():
        if key not in hidden and value != []:
            words = share_words(value) if key == "used_share_of_limit_load" else in_figures(value)
            table.add_row(_IN_WORDS.get(key, key.replace("_", " ")), escape(words))
    table.add_row("groups of the mesh", escape(groups))
    console.print(f"\n[bold]{escape(one_line(scene.title or 'Scene'))}[/bold]")
    console.print(table)
    if relations:
        console.print("Bodies of the geometry that are near each other, as drawn:")
    for line in relations:
        console.print(f"  {one_line(line)}", markup=False, highlight=False, soft_wrap=True)
    for note in notes:
        console.print(f"{one_line(note)}.", markup=False, highlight=False, soft_wrap=True)
    console.print("Energy terms modelled:")
    for term in model.terms:
        console.print(f"  {term}", markup=False)
    _print_motions(console, model.rigid_motions)
    for line in _conditions(scene):
        console.print(one_line(line), markup=False, highlight=False, soft_wrap=True)
    _print_contacts(console, contacts, scene.unit_names)
    for line in cycle_plan(scene, scene.unit_names):
        console.print(one_line(line), markup=False, highlight=False, soft_wrap=True)
    if plan:
        console.print(plan, markup=False, highlight=False, soft_wrap=True)
    held = "supports and contacts can hold the loads"
    moves = "bodies move, whatever holds them"
    console.print(f"The scene can be run: {held if scene.motion is None else moves}.")


def _conditions(scene: Scene) -> list[str]:
    """A line for each support, load and preload, as they were understood."""
    lines, names = [], scene.unit_names

    def unit(of: object, key: str) -> str:
        found = "" if names is None else names.of(measured_by(key, type(of)))
        return f" {found}" if found else ""

    for support in scene.support:
        length = unit(support, "displacement")
        held = [f"{axis} = {_given(value)}{length}" for axis, value in support.displacement.items()]
        if support.rotation is not None:
            turn = support.rotation
            about = "" if turn.axis is None else f" about {_given(turn.axis)}"
            through = "" if turn.at is None else f" through {_given(turn.at)}"
            held.append(f"turned by {turn.angle:g}{about}{through}")
        if support.normal is not None:
            held.append(f"normal = {_given(support.normal)}{length}")
        if not support.is_rigid:
            key = support.key_of_springs
            held += [
                f"{key}.{axis} = {value:g}{unit(support, key)}"
                for axis, value in support.sprung(scene.dimension).items()
            ]
        if support.axes is not None:
            held.append(f"along {_given(support.axes)}")
        on = f" on '{support.on}'" if support.label != support.on else ""
        lines.append(f"Support '{support.label}'{on}: {', '.join(held)}")
    for load in scene.load:
        keys = load.given
        said = [f"{key} {_given(value)}{unit(load, key)}" for key, value in keys.items()]
        if len(keys) == 1:
            (key,) = keys
            said = [f"{load.definition.words_of(load.value)}{said[0].removeprefix(key)}"]
        lines.append(f"Load '{load.on}': {', '.join(said)}")
    for given in scene.temperature:
        of = f"'{given.on}'" if given.on else "all bodies"
        value = f"{_given(given.value)}{unit(given, 'value')}"
        lines.append(f"Temperature of {of}: {f'by {given.file}' if given.file else value}")
    for preload in scene.preload:
        locked = preload.locked_from
        kept = "" if locked is None else f", its length locked from time {locked:g}"
        force = f"{preload.force:g}{unit(preload, 'force')}"
        along = _given(preload.axis)
        place = "" if preload.between is None else f" of '{preload.group}'"
        lines.append(f"Preload '{preload.label}'{place}: force {force} along {along}{kept}")
    for coupling in scene.coupling:
        said = [
            f"{kind} {axis} = {value:g}{unit(coupling, kind) if kind == 'displacement' else ''}"
            for (kind, axis), value in coupling.given.items()
        ]
        said += [
            f"{key} {_given(value)}{unit(coupling, key)}"
            for key in ("force", "moment", "mass")
            if (value := getattr(coupling, key)) is not None
        ]
        on = f" on '{coupling.on}'" if coupling.label != coupling.on else ""
        mean = "" if coupling.is_rigid else ", in the mean"
        lines.append(f"Coupling '{coupling.label}'{on}{mean}: {', '.join(said) or 'free to move'}")
    for spring in scene.spring:
        one, other = spring.between
        said = [
            f"{key} {_given(value) if not isinstance(value, Mapping) else dict(value)}"
            f"{unit(spring, key)}"
            for key in ("stiffness", "rotational_stiffness")
            if (value := getattr(spring, key)) is not None
        ]
        called = "" if spring.name is None else f" '{spring.name}'"
        lines.append(f"Spring{called} between '{one}' and '{other}': {', '.join(said)}")
    for part in registry.parts_of_scene(scene, "words"):
        lines += part.WORDS.plan(scene, names)
    return lines


def _given(value: object) -> str:
    """A value of a scene, or that it varies."""
    if isinstance(value, str):
        return value
    if dataclasses.is_dataclass(value) and not callable(value):  # a table, but no profile
        return ", ".join(f"{key} {_given(part)}" for key, part in given_keys(value).items())
    if isinstance(value, tuple):
        return f"({', '.join(map(_given, value))})"
    return f"{value:.6g}" if isinstance(value, float | int) else "varying"


def _print_motions(console: Terminal, motions: list[RigidMotion]) -> None:
    """A line for each rigid motion that supports leave free, and what may resist it."""
    if motions:
        console.print("Rigid motions that the supports leave free, before contact:")
    for motion in motions:
        words = one_line(f"  {motion_words(motion)}")
        console.print(words, markup=False, highlight=False, soft_wrap=True)


def print_result(result: Result, folder: Path) -> None:
    """Say what came out and whether to trust it."""
    console = Terminal()
    console.print(f"\n[bold]{escape(one_line(result.title or 'Result'))}[/bold]", highlight=False)
    for line in headlines(result):
        console.print(line, markup=False, highlight=False, soft_wrap=True)
    if result.converged:
        _print_quantities(console, result)
        for note in result.error_notes:
            console.print(one_line(note), markup=False, highlight=False, soft_wrap=True)
        _print_contacts(console, result.contacts, result.units)
        _print_checks(console, result.checks)
        _print_branches(console, result)
        _print_asked(console, result)
        _print_levels(console, result)
    console.print(one_line(result.verdict), markup=False, highlight=False)
    took = f"{result.timings['total']:.2f} s"
    if result.steps:  # it may have been interrupted before the first
        took += f", {newton_steps(sum(step.newton_iterations for step in result.steps))}"
        took += " on the last mesh" if len(result.levels) > 1 else ""
    console.print(
        f"{took}. Files in {folder}/",
        markup=False,
        highlight=False,
    )


def _print_quantities(console: Terminal, result: Result) -> None:
    """Values, with bars and units where there are some."""
    bars, units = ["±"] * bool(result.errors), ["unit"] * bool(result.units)
    quantities = _table("quantity", "value", *bars, *units)
    rows = []
    for key in _shown(result):
        rows += quantity_rows(result, key)  # of a resultant, contact by contact
        if key == REACTION and len(result.reactions) > 1:
            rows += [row._replace(name=f"  of {row.name}") for row in reaction_rows(result)]
    for row in [*rows, *preload_rows(result), *coupling_rows(result)]:
        shown = [row.bar] * len(bars) + [row.unit] * len(units)
        quantities.add_row(escape(row.name), row.value, *shown)
    console.print(quantities)


def _print_checks(console: Terminal, checks: Mapping[str, Check]) -> None:
    """The trust report: every check, and what the failed ones compare."""
    table = _table("check", "value", "limit", "")
    failed = [name for name, check in checks.items() if not check.passed]
    for name, check in checks.items():
        parts = check.parts if name in failed else ()
        rows = [(title(name), check), *((f"  of {part.part}", part) for part in parts)]
        for words, shown in rows:
            verdict = "ok" if shown.passed else "[bold red]FAILED[/bold red]"
            numbers = f"{shown.value:.2e}", f"{shown.limit:.2e}"
            table.add_row(escape(one_line(words)), *numbers, verdict)
    console.print(table)
    for name in failed:
        words = f"{title(name)}: {compares(name)}"
        console.print(words, markup=False, highlight=False, soft_wrap=True)


def _print_branches(console: Terminal, result: Result) -> None:
    """All answers that were found, where there are several."""
    rows = branch_rows(result.branches, result.units)
    if rows:
        table = _table(*map(in_figures, rows[0]))
        for row in rows[1:]:
            table.add_row(*map(in_figures, row))
        console.print(table)


def _print_asked(console: Terminal, result: Result) -> None:
    """Print the results of the scene's analyses."""
    for part in registry.parts_of_result(result, "words"):
        for rows in filter(None, part.WORDS.tables(result)):
            table = _table(*map(escape, rows[0]))
            for row in rows[1:]:
                table.add_row(*map(escape, row))
            console.print(table)
        for note in part.WORDS.notes(result):
            console.print(one_line(note), markup=False, highlight=False, soft_wrap=True)


def _print_levels(console: Terminal, result: Result) -> None:
    """Meshes and estimated errors on the way to an accuracy."""
    rows = level_rows(result)
    if rows:
        table = _table(*map(escape, rows[0]))
        for row in rows[1:]:
            table.add_row(*row)
        console.print(table)


def _shown(result: Result) -> list[str]:
    """The quantities that say something about the contacts of a result."""
    hidden = idle_quantities(result.contacts)
    points = [key for key in result.quantities if key.startswith("displacement_")]
    hidden |= secondary_quantities(result.contacts)
    shown = [name for name in with_true_value() if name in result.quantities.keys() - hidden]
    return shown + points


def _print_contacts(
    console: Terminal, contacts: list[ContactRecord], units: UnitNames | UnitsRecord | None
) -> None:
    """A line a contact: its kind, its law, and the parameters that apply."""
    for contact in contacts:
        words = [contact.contact]
        words.append("no friction" if not contact.carries_shear else f"friction law {contact.law}")
        parameters = contact.parameters
        for name in dict.fromkeys((*_PARAMETERS, *parameters)):
            value = parameters.get(name)
            if value:
                written = f"{value:.3g}" if isinstance(value, float) else str(value)
                unit = "" if units is None else units.of(measured_by_parameter(name))
                words.append(f"{name.replace('_', ' ')} {written} {unit}".rstrip())
        if contact.slave is not None:
            words.append(
                f"slave '{contact.slave}' ({contact.slave_reason}), master '{contact.master}'"
            )
        line = f"Contact '{contact.name}': {', '.join(words)}"
        console.print(one_line(line), markup=False, highlight=False, soft_wrap=True)


def _table(*headers: str) -> Table:
    table = Table(box=box.SIMPLE, show_header=any(headers), pad_edge=False)
    for header in headers:
        table.add_column(header)
    return table


def cycle_plan(scene: Scene, names: UnitNames | None) -> Iterator[str]:
    """A line on the cycles of a scene, and one for each contact that wears.

    Args:
        scene: What would be run.
        names: Of its units, if any.
    """
    if scene.cycles is not None:
        yield _cycles(scene, scene.cycles)
    for contact in scene.contact:
        if contact.wear is not None:
            yield _wear(contact, contact.wear, names)


def _cycles(scene: Scene, cycles: Cycles) -> str:
    """How many, and how many load steps that takes."""
    each, own = load_steps_in_cycle(scene), registry.takes_steps_of(scene)
    if each is None:
        steps, total = "automatic load steps", ""
    else:
        steps = f"{each} load steps each"
        total = f", {cycles.number * each:,} load steps" if own is None else ""
    words = (
        f"Cycles: {cycles.number:,} of {steps}{total}, the first from time {cycles.begin:g} to "
        f"{cycles.end:g}"
    )
    if own is not None:
        return f"{words}; {own.part('words').WORDS.cycle_plan(cycles)}"
    return f"{words}; none after the loop is closed" if cycles.until == "closed" else words


def _wear(contact: Contact, wear: Wear, names: UnitNames | None) -> str:
    """Return in words by which law a contact wears, and where."""
    given = wear.coefficient
    value = f"{given:.6g}" if isinstance(given, float | int) else "that varies"
    unit = "" if names is None else f" {names.of(measured_by('coefficient', Wear))}"
    words = f"Wear at '{contact.label}', at each point that slips: Archard's law, k {value}{unit}"
    if wear.threshold:
        stress = "" if names is None else f" {names.of(measured_by('threshold', Wear))}"
        words += f", above a pressure of {wear.threshold:g}{stress}"
    if wear.share is not None:
        words += f"; '{contact.on}' loses {100 * wear.share:g} % of the depth"
    return words
