"""Answers of a scene with other numbers: their quantities, and where contact and stick end."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import total
from fenics_contact.evaluate.contact_areas import areas_inside, cut_areas
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.studies.changes import with_changes
from fenics_contact.simulation.studies.kept_body import KeptBody
from fenics_contact.simulation.studies.quick_answers import QuickAnswers
from fenics_contact.simulation.sweeps.rows import row_of_quick
from fenics_contact.solve.newton.solution import Solution


@dataclass(frozen=True, eq=False)
class WindowAnswer:
    """An answer somewhere in a window.

    Attributes:
        values: Quantities by the names that they are asked for, None where there is none.
        inside: Of each edge, the area of this rank's pieces that lies inside of it.
        strips: Of each edge, the area of the cells that it passes through.
    """

    values: Mapping[str, float | None]
    inside: Sequence[Array]
    strips: Sequence[float]


class WindowAnswers:
    """Quick answers on one body, each solved once; collective.

    Every contact has two edges, that of contact and that of stick.

    Args:
        kept: The body.
        scene: The scene whose numbers change.
    """

    def __init__(self, kept: KeptBody, scene: Scene) -> None:
        self.scene = scene
        self._quick = QuickAnswers(kept)
        self._comm = kept.discrete.spaces.comm
        self._known: dict[tuple[str, float], WindowAnswer | None] = {}

    def at(self, key: str, value: float) -> WindowAnswer | None:
        """The answer with another number; None where the scene has none with it; collective.

        Args:
            key: Of the number.
            value: In its place.
        """
        if (key, value) not in self._known:
            try:
                scene = with_changes(self.scene, {key: value})
                self._known[key, value] = self.of(scene)
            except InputError:  # beyond what the key can be, or what supports and friction hold
                self._known[key, value] = None
        return self._known[key, value]

    def of(self, scene: Scene) -> WindowAnswer | None:
        """The answer of a scene on the same body, None where there is none; collective."""
        inside: list[Array] = []
        strips: list[float] = []

        def watch(problem: Problem, solution: Solution) -> None:
            for contact, state in zip(problem.contacts, solution.states, strict=True):
                inside.extend(areas_inside(contact, state))
                degree = problem.spaces.degree  # pieces end at nodes
                strips.extend(degree * area for area in cut_areas(contact, state))

        answer = self._quick.answer(scene, follow=False, checks=False, watch=watch)
        if not answer.converged:
            return None
        names = [contact.label for contact in scene.contact]
        return WindowAnswer(row_of_quick(answer, names), inside, strips)

    def moved(self, one: WindowAnswer, other: WindowAnswer, strips: Sequence[float]) -> Array:
        """Return by how many cells each edge has moved between two answers; collective.

        Args:
            one: An answer.
            other: The other one.
            strips: Of the answer in the middle.
        """
        pairs = zip(one.inside, other.inside, strict=True)
        areas = total(self._comm, np.array([float(np.abs(a - b).sum()) for a, b in pairs]))
        widths = np.asarray(strips)
        return np.asarray(np.where(widths > 0, areas / np.where(widths > 0, widths, 1.0), 0.0))
