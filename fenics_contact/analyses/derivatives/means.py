"""Mean derivatives about an answer: of each number, in the window that its own change makes.

A number that the body depends on, such as a modulus, would need another body for each answer. Its
exact derivatives are averaged instead, along a multiple of all that loads the scene.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, NamedTuple

from fenics_contact.analyses.derivatives.windows import (
    INTERVALS,
    INTERVALS_OF_AREAS,
    Answers,
    Window,
    WindowAnswer,
    WindowAnswers,
    find_window,
)
from fenics_contact.body.description import BodyDescription
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError, NotConvergedError
from fenics_contact.quantities import table
from fenics_contact.quantities.names import MAX_CONTACT_PRESSURE, PRESSURE_INTEGRAL, STRAIN_ENERGY
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.load_kinds import times
from fenics_contact.scene.loading.temperatures import largest_expansion, largest_rise
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.sensitivities.derivatives import Derivatives
from fenics_contact.simulation.sensitivities.scene_values import found_in, numbered, with_changes
from fenics_contact.simulation.studies.kept_body import KeptBody
from fenics_contact.simulation.studies.solved_derivatives import (
    SolvedDerivatives,
    solved_derivatives,
)


class Mean(NamedTuple):
    """A mean derivative.

    Attributes:
        value: The derivative.
        spread: How far derivatives of single answers lie from it.
        of_single_answers: Whether its window is narrower than a cell.
    """

    value: float
    spread: float
    of_single_answers: bool


# A number smaller than this share of what its changes are measured by counts as 0.
_NOTHING = 1e-3
# Of a material that does not expand: about that of glass (1/temperature).
_EXPANSION = 1e-5
# Cells that an edge moves by, from end to end of a window that is as wide as one.
_A_CELL = 0.8


class Means:
    """Means of derivatives about the answer of a scene; collective.

    Args:
        kept: The body.
        scene: The scene.
        names: Of quantities.
        keys: Of numbers.
        exact: Derivatives of the answer itself.
    """

    def __init__(
        self,
        kept: KeptBody,
        scene: Scene,
        names: list[str],
        keys: Sequence[str],
        exact: SolvedDerivatives,
    ) -> None:
        self._kept, self._scene, self._names, self._keys = kept, scene, names, keys
        self._with_exact = list(exact.slopes)
        has_areas = any(table.edges_of(scene.names.find(name).quantity) for name in names)
        self._intervals = INTERVALS_OF_AREAS if has_areas else INTERVALS
        self._answers = WindowAnswers(kept, scene)
        self._middle = self._answers.of(scene)

    def quantity(self, name: str) -> float | None:
        """The quantity itself, None where there is none."""
        return None if self._middle is None else self._middle.values.get(name)

    def by(self, key: str) -> Mapping[str, Mean]:
        """Return the mean derivatives by a number, of each quantity that has one; collective."""
        if self._middle is None:
            return {}
        number = float(found_in(self._scene, key))
        if self._is_of_body(key, number):
            return self._of_body.get(key, {})

        def at(place: float) -> WindowAnswer | None:
            return self._answers.at(key, place)

        window = self._window(at, number, self._size(key, number))
        if window is None:
            return {}
        answers = [at(float(place)) for place in window.places]
        solved = [answer.values for answer in answers if answer is not None]
        if len(solved) < len(answers):
            return {}
        values = {name: [found.get(name) for found in solved] for name in self._names}
        known = {name: found for name, found in values.items() if None not in found}
        first, *_, last = (answer for answer in answers if answer is not None)
        return {
            name: Mean(
                *self._in(window, name)([value for value in found if value is not None]),
                window.is_narrow,
            )
            for name, found in known.items()
            if self._is_averaged(name, first, last)
        }

    def _in(self, window: Window, name: str) -> Callable[[list[float]], tuple[float, float]]:
        """How a derivative follows from answers in a window: areas jump there."""
        is_area = bool(table.edges_of(self._scene.names.find(name).quantity))
        return window.mean if is_area else window.slope

    def _is_averaged(self, name: str, first: WindowAnswer, last: WindowAnswer) -> bool:
        """Whether edges move by a cell from end to end of a window, those that bound an area.

        Else an area has jumped there, or it has not: that says nothing of its derivative.
        """
        middle, asked = self._middle, self._scene.names.find(name)
        assert middle is not None
        edges = table.edges_of(asked.quantity)
        if not edges:
            return True
        moved = self._answers.moved(first, last, middle.strips)
        first_of = [2 * number for number in range(len(self._scene.names.contacts))]
        if asked.owner:
            first_of = [2 * self._scene.names.contacts.index(asked.owner)]
        return all(moved[place + edge.value] >= _A_CELL for place in first_of for edge in edges)

    def _is_of_body(self, key: str, number: float) -> bool:
        """Whether another number makes another body."""
        try:
            other = with_changes(self._scene, {key: number * 1.001 or _NOTHING})
        except InputError:
            return False  # there are no others on that side
        return bool(BodyDescription.of(self._scene).differences(BodyDescription.of(other)))

    def _window(self, answers: Answers, number: float, size: float) -> Window | None:
        middle = self._middle
        assert middle is not None

        def moved(one: WindowAnswer, other: WindowAnswer) -> Array:
            return self._answers.moved(one, other, middle.strips)

        return find_window(answers, moved, number, size, self._intervals)

    def _size(self, key: str, number: float) -> float:
        """Return the size that changes of a number are compared with: its own or its kind's."""
        middle = self._middle
        assert middle is not None
        table, *names = numbered(self._scene, key).split(".")
        if table == "load":
            scale = self._present(self._scene.load[int(names[0])].definition.measured_by)
        elif "pressure" in names:
            scale = self._present(MAX_CONTACT_PRESSURE)
        elif "force" in names:
            scale = self._present(PRESSURE_INTEGRAL)
        elif table == "temperature" or names[-1] == "reference_temperature":
            return largest_rise(self._scene.temperature, self._scene.material)
        elif names[-1] == "thermal_expansion":
            return abs(number) or max(map(largest_expansion, self._scene.material)) or _EXPANSION
        elif "position" in names:  # of the cells at the edges, but in 3D, where there are many
            scale = max(middle.strips, default=0.0) or 1.0
        else:
            scale = 2 * self._present(STRAIN_ENERGY) / self._present(PRESSURE_INTEGRAL)
        return abs(number) if abs(number) > _NOTHING * scale else scale

    def _present(self, quantity: str) -> float:
        """The largest size of a quantity in the answer, of all contacts; 1 where it is 0."""
        middle = self._middle
        assert middle is not None
        sizes = [abs(v) for name, v in middle.values.items() if name.endswith(quantity) and v]
        return max(sizes, default=1.0)

    @cached_property
    def _of_body(self) -> dict[str, dict[str, Mean]]:
        """Key → quantity → mean, of numbers that the body depends on; collective."""
        keys = [
            key for key in self._keys if self._is_of_body(key, float(found_in(self._scene, key)))
        ]
        names = self._with_exact
        samples, window = self._along_drive(names, keys)
        if not samples or window is None:
            return {}
        return {
            key: {
                name: Mean(*window.at_middle([s[name][key] for s in samples]), window.is_narrow)
                for name in names
            }
            for key in keys
        }

    def _along_drive(
        self, names: list[str], keys: list[str]
    ) -> tuple[list[Derivatives], Window | None]:
        """Exact derivatives along the window of a multiple of all loads; none where some fail."""

        def at(factor: float) -> WindowAnswer | None:
            try:
                return self._answers.of(driven(self._scene, factor))
            except InputError:
                return None

        window = self._window(at, 1.0, 1.0)
        if window is None:
            return [], None
        try:
            samples = [
                solved_derivatives(self._kept, driven(self._scene, float(s)), names, keys).slopes
                for s in window.middles
            ]
        except (InputError, NotConvergedError):
            return [], window
        return samples, window


def driven(scene: Scene, factor: float) -> Scene:
    """The scene with all that is done to it times a factor: loads, motions, preloads, expansions.

    Args:
        scene: A scene.
        factor: 1 leaves it as it is.
    """
    supports = [one.times(factor) for one in scene.support]
    loads = [one.times(factor) for one in scene.load]
    preloads = [replace(one, force=factor * one.force) for one in scene.preload]
    return replace(
        scene,
        support=tuple(supports),
        load=tuple(loads),
        preload=tuple(preloads),
        material=tuple(_material(one, factor) for one in scene.material),
        contact=tuple(_contact(one, factor) for one in scene.contact),
    )


def _material(material: Material, factor: float) -> Material:
    """With its thermal expansion times a factor, as thermal strains then are."""
    if material.thermal_expansion is None:
        return material
    return replace(material, thermal_expansion=times(material.thermal_expansion, factor))


def _contact(contact: Contact, factor: float) -> Contact:
    changes: dict[str, Any] = {"interference": times(contact.interference, factor)}
    if contact.pressure is not None:
        changes["pressure"] = times(contact.pressure, factor)
    if contact.obstacle is not None:
        changes["obstacle"] = contact.obstacle.times(factor)
    return replace(contact, **changes)
