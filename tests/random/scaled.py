"""Scenes in other units, or of another thickness, and what has to become of their results.

Nothing but a factor: of length, force and thickness as each quantity measures them.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fenics_contact import Result, Scene
from fenics_contact.quantities.names import STRAIN_OF_POINTS
from fenics_contact.quantities.table import has_true_value, measured_by
from fenics_contact.results.quantities import measured_by_parameter
from fenics_contact.scene.units.dimensions import Dimension
from fenics_contact.scene.units.table import dimensions
from tests.random.scenes import RandomScene

# Length and force of a scene in m and N in other units.
SYSTEMS = {
    "mm, N": (1e3, 1.0),
    "cm, N": (1e2, 1.0),
    "in, lbf": (1 / 0.0254, 1 / 4.4482216152605),
    "km, N": (1e-3, 1.0),
    "um, uN": (1e6, 1e6),
    "mm, kN": (1e3, 1e-3),
}
# Powers of length, force and of the thickness where there is one.
_POWERS = {
    "": (0, 0, 0),
    "length": (1, 0, 0),
    "stress": (-2, 1, 0),
    "force": (0, 1, 1),
    "area": (2, 0, 1),
    "energy": (1, 1, 1),
    "volume": (3, 0, 1),
    "length/stress": (3, -1, 0),
    "stress/length": (-3, 1, 0),
}


@dataclass(frozen=True)
class Factors:
    """By what numbers of a scene are multiplied.

    Attributes:
        length: Of lengths.
        force: Of forces.
        thickness: The new one of a model in plane stress that has none.
    """

    length: float = 1.0
    force: float = 1.0
    thickness: float | None = None

    def of(self, length: float, force: float, is_resultant: bool, per_length: bool) -> float:
        """The factor of a number.

        Args:
            length: Power of length.
            force: Power of force.
            is_resultant: Whether models of unit thickness have it per length.
            per_length: Whether the scene is one.
        """
        thick = is_resultant and per_length
        found = self.length ** (length - thick) * self.force**force
        return found * (self.thickness or 1.0) if thick else found

    def of_quantity(self, words: str, per_length: bool) -> float:
        """The same of what a result measures.

        Args:
            words: As in ``results.quantities``.
            per_length: Whether the scene is one of unit thickness.
        """
        length, force, resultant = _POWERS[words]
        return self.of(length, force, bool(resultant), per_length)


@dataclass(frozen=True)
class _Function:
    """A function of places, in UFL or of arrays, in other units."""

    own: Callable[[Any], Any]
    length: float
    factor: float

    def __call__(self, x: Any) -> Any:
        return self.factor * self.own(x / self.length)


@dataclass(frozen=True)
class _Shape:
    """A map of points, in other units."""

    own: Callable[[Any], Any]
    length: float

    def __call__(self, points: Any) -> Any:
        return self.length * self.own(points)


def scaled(random: RandomScene, factors: Factors) -> RandomScene:
    """The same scene in other units, or of a thickness.

    Args:
        random: The scene; for a thickness one in plane stress that has none.
        factors: Of its numbers. Given forces follow the thickness.
    """
    scene = _table(random.scene, factors, random.scene.is_per_unit_thickness, None)
    if factors.thickness is not None:
        scene = dataclasses.replace(scene, thickness=factors.thickness)
    return dataclasses.replace(random, scene=scene, shape=_Shape(random.shape, factors.length))


def _table(table: Any, factors: Factors, per_length: bool, outer: Dimension | None) -> Any:
    changes = {}
    for name, dimension in dimensions(table):
        value = getattr(table, name)
        measured = dimension.of(table, outer) if dimension is not None else None
        found = _scaled(value, factors, per_length, measured)
        if found is not value:
            changes[name] = found
    return dataclasses.replace(table, **changes) if changes else table


def _scaled(value: Any, factors: Factors, per_length: bool, dimension: Dimension | None) -> Any:
    if isinstance(value, Mapping):
        return {name: _scaled(v, factors, per_length, dimension) for name, v in value.items()}
    if isinstance(value, tuple):
        return tuple(_scaled(part, factors, per_length, dimension) for part in value)
    if hasattr(type(value), "__pydantic_fields__"):
        return _table(value, factors, per_length, dimension)
    if value is None or dimension is None or isinstance(value, str | bool):
        return value
    factor = factors.of(dimension.length, dimension.force, dimension.is_resultant, per_length)
    if callable(value):
        return _Function(value, factors.length, factor)
    return factor * value


# Of values, as they are solved for; of bars, which are differences of answers.
_VALUE, _BAR = 1e-7, 2e-2
# Of the penalty; and powers of ten of the regularisation, which follows the pressure of some
# iteration, one of several that will do.
_EXACT, _POWERS_OF_TEN = 1e-9, 1.0
# Bars that are compared: others follow from the regularisation that was chosen.
_COMPARED = ("mesh", "total")


@dataclass(frozen=True)
class _Number:
    """One of a result, in the units of the scene that it is compared with.

    Attributes:
        value: It, with all components; None where there is none.
        most: By how much two may differ.
    """

    value: Any
    most: float


def differences(scene: Scene, one: Result, other: Result, factors: Factors) -> list[str]:
    """What of two results differs, other than by the factors.

    Values may differ by what iterations and regularisation leave, as their bars say.

    Args:
        scene: Of the one.
        one: Its result.
        other: That of the scaled scene.
        factors: By which that was scaled.
    """
    if one.exit_code != other.exit_code:
        return [f"exit code {one.exit_code} and {other.exit_code}: {other.verdict}"]
    per_length = scene.is_per_unit_thickness
    ours, theirs = (
        dict(_numbers(result, by, per_length))
        for result, by in ((one, Factors()), (other, factors))
    )
    found = [f"{name} is there once" for name in ours.keys() ^ theirs.keys()]
    for name in ours.keys() & theirs.keys():
        a, b = ours[name].value, theirs[name].value
        most = ours[name].most + theirs[name].most
        if (a is None) != (b is None) or (
            a is not None and np.linalg.norm(np.subtract(a, b)) > most
        ):
            found.append(f"{name}: {a} and {b}")
    return sorted(found)


def _alike(one: Any, other: Any, most: float) -> bool:
    """Whether two numbers differ by no more, or neither is there."""
    if one is None or other is None:
        return one is other
    return bool(np.linalg.norm(np.subtract(one, other)) <= most)


def _left(bars: dict[str, Any]) -> float:
    """What the regularisation and the iterations leave of a quantity."""
    return sum(bars.get(source) or 0.0 for source in ("regularisation", "iteration"))


def _numbers(result: Result, factors: Factors, per_length: bool) -> Iterator[tuple[str, _Number]]:
    for row in result.contacts:
        for name, value in row["parameters"].items():
            if value is None:
                continue
            value = value / factors.of_quantity(measured_by_parameter(name), per_length)
            number = _Number(value, _EXACT * abs(value))
            if name == "regularisation_parameter" and value > 0:
                number = _Number(np.log10(value), 0.5 * _POWERS_OF_TEN)
            yield f"{row['name']}.{name}", number
    rows = [
        (name, kind, None if value is None else np.asarray(value, dtype=float) / factor, bars)
        for name, kind, value, bars, factor in _quantities(result, factors, per_length)
    ]
    sizes: dict[str, float] = {}
    for _, kind, value, _ in rows:
        size = 0.0 if value is None else float(np.linalg.norm(value))
        sizes[kind] = max(sizes.get(kind, 0.0), size)
    # A stress at a point has no bar: of it remains what remains of other stresses.
    largest: dict[str, float] = {}
    for _, kind, _, bars in rows:
        largest[kind] = max(largest.get(kind, 0.0), _left(bars))
    strains = [value for name, _, value, _ in rows if name.startswith(STRAIN_OF_POINTS)]
    strained = max((abs(float(value)) for value in strains if value is not None), default=0.0)
    of_stress = largest.get("stress", 0.0) / (sizes.get("stress", 0.0) or 1.0)
    for name, kind, value, bars in rows:
        least = _VALUE * sizes[kind]
        if name.startswith(STRAIN_OF_POINTS):
            least += of_stress * strained
        left = _left(bars) if bars else largest[kind]
        yield name, _Number(value, least + left)
        for source in _COMPARED:
            bar = bars.get(source)
            yield f"{name} ± {source}", _Number(bar, least + _BAR * (bar or 0.0) + left)


def _quantities(
    result: Result, factors: Factors, per_length: bool
) -> Iterator[tuple[str, str, Any, dict[str, float | None], float]]:
    """Names, what they measure, values, bars in the units of the other scene, and factors."""
    tables = [("", result.quantities, result.errors)]
    tables += [(f"{c['name']}.", c["quantities"], c.get("errors")) for c in result.contacts]
    tables += [
        (f"{row['name']} {number}.", {"reaction": row["reaction"]}, row.get("errors"))
        for number, row in enumerate(result.supports)
    ]
    for prefix, quantities, errors in tables:
        for name, value in quantities.items():
            if has_true_value(name):
                kind = measured_by(name)
                factor = factors.of_quantity(kind, per_length)
                row = (errors or {}).get(name) or {}
                bars = {k: None if bar is None else bar / factor for k, bar in row.items()}
                yield prefix + name, kind, value, bars, factor


def smaller(random: RandomScene, most: int) -> RandomScene:
    """The same with few cells.

    Args:
        random: The scene.
        most: Cells along each axis.
    """
    parts = tuple(
        dataclasses.replace(part, cells=tuple(min(count, most) for count in part.cells))
        for part in random.parts
    )
    return dataclasses.replace(random, parts=parts)


def plane_stress(random: RandomScene) -> RandomScene:
    """The same in plane stress, which may have a thickness.

    Args:
        random: A plane scene.
    """
    scene = dataclasses.replace(random.scene, kinematics="plane stress")
    return dataclasses.replace(random, scene=scene)
