"""Results of the load steps of a run as curves, from its ``result.json``."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.analyses import registry
from fenics_contact.common.arrays import Array
from fenics_contact.quantities.names import (
    CONTACT_AREA,
    FRICTION_FORCE,
    INDENTATION,
    KINETIC_ENERGY,
    NORMAL_FORCE,
    OBSTACLE_DISPLACEMENT,
    REACTION,
    STICK_AREA,
)
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.run import Outcome
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.scene.units.dimensions import UnitNames

_AXES = "xyz"
# What varies by less than this share of the largest stands still: a pressed obstacle that is moved
# sideways sinks in by next to nothing.
_STILL = 1e-3
# Called with number and record of every load step that was accepted.
Announce = Callable[[int, StepRecord], None]


@dataclass(frozen=True)
class Drive:
    """Something that is moved and what it takes, step by step.

    Attributes:
        title: What is moved, in words.
        moved: Words and symbol of how far.
        force: Words and symbol of what acts on the body there.
        x: How far (length).
        y: The force.
    """

    title: str
    moved: str
    force: str
    x: Array
    y: Array


@dataclass(frozen=True)
class History:
    """The load steps that have an answer.

    Attributes:
        steps: Their records.
        time: Pseudo-times.
    """

    steps: list[StepRecord]
    time: Array

    @classmethod
    def of(cls, result: Outcome) -> History:
        """Return the history of a run."""
        steps = [step for step in result.steps if step.quantities]
        return cls(steps, np.array([step.load_factor for step in steps]))

    @property
    def clock(self) -> str:
        """Name of its times: ``time`` where bodies move, else ``pseudo-time``."""
        return clock_of(self.steps)

    def quantity(self, name: str) -> Array:
        """A quantity of the whole model, (steps,) or (steps, components); no number if unknown."""
        return np.array([step.quantities[name] for step in self.steps], dtype=np.float64)

    def of_contact(self, number: int, name: str) -> Array | None:
        """A quantity of a contact, likewise; None where it is not known of every step."""
        found = [step.contacts[number].quantities.get(name) for step in self.steps]
        return None if any(value is None for value in found) else np.array(found)

    def drives(self, contacts: list[ContactRecord], far: tuple[str, ...] = ()) -> list[Drive]:
        """Obstacles and supports that are moved, and loads that vary.

        Args:
            contacts: Of the run.
            far: Names of supports that are none: they move as a half-space does.
        """
        return [*self._obstacles(contacts), *self._supports(far), *self._loads()]

    def _obstacles(self, contacts: list[ContactRecord]) -> Iterator[Drive]:
        for number, contact in enumerate(contacts):
            where = f"the obstacle at '{contact.name}'"
            depth = self.of_contact(number, INDENTATION)
            normal = self.of_contact(number, NORMAL_FORCE)
            if depth is not None and normal is not None and _varies(depth):
                yield Drive(where, r"indentation, $\delta$", "normal force, $P$", depth, normal)
            moved = self.of_contact(number, OBSTACLE_DISPLACEMENT)
            friction = self.of_contact(number, FRICTION_FORCE)
            if moved is not None and friction is not None and contact.carries_shear:
                yield from _along(where, moved, friction, "friction force", "Q")

    def _supports(self, far: tuple[str, ...]) -> Iterator[Drive]:
        for number, support in enumerate(self.steps[0].supports):
            if support.on in far:
                continue
            rows = [step.supports[number] for step in self.steps]
            held = [value is not None for value in support.displacement]
            means = np.array([row.displacement for row in rows], dtype=np.float64)
            moved = np.where(held, means, 0.0)
            reaction = np.array([row.reaction for row in rows], dtype=np.float64) * held
            where = f"the support '{support.name}'"
            yield from _along(where, moved, reaction, REACTION, "R")

    def _loads(self) -> Iterator[Drive]:
        for number, load in enumerate(self.steps[0].loads):
            rows = [step.loads[number] for step in self.steps]
            moved = np.array([row.displacement for row in rows])
            force = np.array([row.force for row in rows])
            if _varies(moved) and _varies(force):
                kind, on = load.name.split(" on ", 1)
                where = f"the {kind} on '{on}'"
                yield Drive(where, "displacement along it, $u$", "force, $F$", moved, force)


def _along(where: str, moved: Array, force: Array, word: str, symbol: str) -> Iterator[Drive]:
    """A drive along the axis, or the direction, in which something moves; none where it does not.

    Args:
        where: What is moved.
        moved: How far, (steps, components) (length).
        force: On the body, likewise.
        word: For the force.
        symbol: For the force.
    """
    if not _varies(moved):
        return
    farthest = moved[np.argmax(np.linalg.norm(moved - moved[0], axis=1))] - moved[0]
    direction = farthest / np.linalg.norm(farthest)
    axis = int(np.argmax(np.abs(direction)))
    name, along = _AXES[axis], ""
    if abs(direction[axis]) > 1 - 1e-6:
        direction = np.eye(len(direction))[axis]
    else:
        name, along = "s", f" along ({', '.join(f'{x:.2g}' for x in direction)})"
    yield Drive(
        where,
        f"displacement{along}, $u_{name}$",
        f"{word}, ${symbol}_{name}$",
        moved @ direction,
        force @ direction,
    )


def _varies(values: Array) -> bool:
    return bool(np.ptp(values, axis=0).max() > _STILL * np.abs(values).max())


def clock_of(steps: Sequence[StepRecord]) -> str:
    """Return the name of the steps' times: ``time`` where bodies move, else ``pseudo-time``."""
    moves = any(KINETIC_ENERGY in step.quantities for step in steps)
    return "time" if moves else "pseudo-time"


def newton_steps(number: int) -> str:
    """So many Newton steps, in words."""
    return f"{number} Newton step{'' if number == 1 else 's'}"


def step_line(number: int, step: StepRecord, units: UnitNames | None = None) -> str:
    """A load step in one line.

    Args:
        number: Counted from 1.
        step: Its record.
        units: Of the scene, if any.
    """
    own = registry.part_of_cycle(step.cycle, "words")
    if own is not None:
        return str(own.WORDS.step_line(step, units))
    area = "" if units is None else f" {units.of('area')}"
    found, passes = step.quantities, step.outer_iterations
    counted = f", {passes} pass{'es' if passes > 1 else ''}" if passes else ""
    return (
        f"step {number}: time {step.load_factor:.6g}, {newton_steps(step.newton_iterations)}"
        f"{counted}, contact area {found[CONTACT_AREA]:.4g}{area}, "
        f"sticking {found[STICK_AREA]:.4g}{area}"
    )
