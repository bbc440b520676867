"""Sentences of `check` on repeated loads, and on contacts that wear."""

from __future__ import annotations

from collections.abc import Iterator

from fenics_contact.analyses import registry
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.laws.wear import Wear
from fenics_contact.scene.loading.cycles import Cycles
from fenics_contact.scene.loading.load_paths import load_steps_in_cycle
from fenics_contact.scene.reference import measured_by
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.units.dimensions import UnitNames


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
