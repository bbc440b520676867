"""Quantities that no mesh brings to an end: known beforehand, or seen from mesh to mesh.

A quantity that converges moves from one mesh to the next by less than the bars of both, and less
and less. One that does not, such as a force where displacements jump, grows by about as much with
every mesh, like the logarithm of one over the cells' size, while each bar sees its own mesh only.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Hashable, Mapping, Sequence
from itertools import pairwise
from typing import TypeVar

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities import table
from fenics_contact.quantities.names import FRICTION_FORCE, REACTION
from fenics_contact.quantities.quantity import Singular, Together
from fenics_contact.quantities.table import QuantityValue
from fenics_contact.results.records.contacts import ReactionRecord, SupportRecord
from fenics_contact.results.result import Result
from fenics_contact.scene.quantity_names import Reaction
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.convergence.body_corners import Corner, singular_corners
from fenics_contact.trust.convergence.displacement_jumps import Jump, displacement_jumps

Row = dict[str, float | None]

# Over itself, below which a resultant is what loads make it, an area that of the whole surface: no
# mesh changes it.
_GIVEN = 1e-6


class Unbounded:
    """Quantities of a solution that do not converge; collective.

    Args:
        problem: In the state of the answer.
        solution: The answer.
        time: Its pseudo-time.
    """

    def __init__(self, problem: Problem, solution: Solution, time: float) -> None:
        self._problem = problem
        self._jumps = displacement_jumps(problem, solution.displacement, time)
        self._corners = singular_corners(problem, solution.states)

    def strip(
        self, rows: Mapping[Hashable, Row], answer: Mapping[Hashable, QuantityValue]
    ) -> tuple[dict[Hashable, Row], dict[Hashable, str]]:
        """Rows of an error budget without the error by the mesh of what does not converge.

        Args:
            rows: By the keys of a budget.
            answer: The quantities, by the same keys.

        Returns:
            All rows, and the sentence on each that is without.
        """
        found = dict(rows)
        why: dict[Hashable, str] = {}
        for jump in self._jumps:
            keys = [
                key
                for key, row in rows.items()
                if self._is_of(jump, key) and not _is_given(key, row, answer.get(key))
            ]
            if keys:
                sentence = self._sentence(jump, keys)
                for key in keys:
                    found[key] = rows[key] | {"mesh": None, "total": None}
                    why.setdefault(key, sentence)
        for corner in self._corners:
            for key in rows:
                number, name = key if isinstance(key, tuple) else (corner.contact, key)
                if number == corner.contact and _has_no_bound_at_corners(name) and key not in why:
                    found[key] = rows[key] | {"mesh": None, "total": None}
                    why[key] = self._of_corner(corner)
        return found, why

    def _is_of(self, jump: Jump, key: Hashable) -> bool:
        """Whether a jump keeps a quantity from converging.

        An obstacle that a force drives gives way, like one over the logarithm of one over the
        cells' size, and all that its place decides about goes with it.
        """
        if self._gives_way(jump):
            return True
        if isinstance(key, Reaction):
            return self._is_of_supports(jump, key.of)
        number, name = key if isinstance(key, tuple) else (None, key)
        if number is None and _follows(name) is Singular.ENERGY:
            return True
        contacts = jump.contacts if number is None else {number} & set(jump.contacts)
        touched = [self._problem.contacts[found] for found in contacts]
        if name == FRICTION_FORCE:
            return any(contact.can_shear for contact in touched)
        if name == REACTION and number is None:
            # Between supports, also of two bodies that touch, forces cancel in the sum.
            driven = [c for c in touched if not c.kinematics.faces_body]
            return bool(jump.supports and driven)
        return bool(touched) and _follows(name) in (Singular.RESULTANT, Singular.PEAK)

    def _gives_way(self, jump: Jump) -> bool:
        return any(self._problem.contacts[number].gives_way for number in jump.contacts)

    def _is_of_supports(self, jump: Jump, of: int | str) -> bool:
        """Whether a jump keeps the reaction of a support, or of all of a name, from converging.

        A step of their own displacements does not: the forces on both sides of it cancel.
        """
        supports = self._problem.applied_supports
        own = {n for n in jump.supports if of in (n, supports[n].name)}
        return bool(own and (jump.contacts or set(jump.supports) - own))

    def _sentence(self, jump: Jump, keys: list[Hashable]) -> str:
        names = list(dict.fromkeys(self._words(key) for key in keys))
        components = self._problem.spaces.components
        place = ", ".join(f"{x + 0.0:.4g}" for x in np.round(jump.place[:components], 12))
        own = [f"the contact '{self._problem.contacts[n].label}'" for n in jump.contacts]
        supports = self._problem.applied_supports
        own += [f"the support '{supports[n].name}'" for n in jump.supports]
        ask = "prescribe displacements that differ" if len(own) > 1 else "prescribes a step"
        if self._gives_way(jump):
            return (
                f"Only what loads alone decide has an error bar: at ({place}) {_listed(own)} {ask} "
                f"by {jump.size:.3g}, so that stress has no bound there, the obstacle gives way "
                "more with every refinement, and all else changes with it."
            )
        verb = "do" if len(names) > 1 else "does"
        return (
            f"{_listed(names)} {verb} not converge: at ({place}) {_listed(own)} {ask} by "
            f"{jump.size:.3g}, so that stress has no bound there, and finer cells give ever larger "
            "numbers."
        )

    def _of_corner(self, corner: Corner) -> str:
        label = self._problem.contacts[corner.contact].label
        place = ", ".join(f"{x + 0.0:.4g}" for x in np.round(corner.place, 12))
        friction = " under friction" if corner.rubs else ""
        return (
            f"The largest pressure at the contact '{label}' does not converge: at ({place}) it "
            f"reaches a corner of the body of {corner.angle:.3g}°, where stress has no bound"
            f"{friction}, and finer cells give ever larger numbers. Forces and areas do converge."
        )

    def _words(self, key: Hashable) -> str:
        if not isinstance(key, Reaction):
            return str(key[1] if isinstance(key, tuple) else key).replace("_", " ")
        supports = self._problem.applied_supports
        of = supports[key.of].name if isinstance(key.of, int) else key.of
        return f"{key.quantity.replace('_', ' ')} of '{of}'"


def _follows(name: Hashable) -> Singular | None:
    """The kind by which a quantity converges, or not, where stress has no bound; or None."""
    row = table.find(str(name))
    return None if row is None else row.singular


def _has_no_bound_at_corners(name: Hashable) -> bool:
    """Whether it has none at corners of bodies that are pressed, as forces and energies have."""
    row = table.find(str(name))
    return row is not None and row.singular is Singular.PEAK and row.together is Together.LARGEST


def _is_given(key: Hashable, row: Row, value: QuantityValue | None) -> bool:
    """Whether loads alone make a quantity what it is, so that the mesh has no part in it."""
    name = key[1] if isinstance(key, tuple) else key
    if _follows(name) in (Singular.PEAK, Singular.ENERGY) or row["mesh"] is None or value is None:
        return False
    return row["mesh"] <= _GIVEN * float(np.linalg.norm(value))


def _listed(words: list[str]) -> str:
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


Held = TypeVar("Held", SupportRecord, ReactionRecord)

# What a move is over the one before, at the least, of what does not converge. Half is the order of
# a force beside a displacement r^½, the strongest singularity of a body that is not torn, on cells
# of half the size.
_BEYOND_BARS = 0.5
# Likewise where the bars cover the moves: then of one more move, and a bar that falls no faster.
_STEADY = 0.7
# Over the bar, below which moves say nothing.
_SMALL = 0.1


class LevelHistory:
    """Values and bars of all quantities of a run, mesh after mesh, by the keys of its budget.

    >>> history = LevelHistory()
    >>> for force in (10.0, 13.5, 17.2):  # by as much with every mesh
    ...     history.values.append({"normal_force": np.array([force])})
    ...     history.bars.append({"normal_force": 0.6})
    >>> history.is_beyond("normal_force"), history.runs_away("normal_force")
    (True, True)
    """

    def __init__(self) -> None:
        self.values: list[Mapping[Hashable, Array]] = []
        self.bars: list[Mapping[Hashable, float | None]] = []

    def add(self, result: Result) -> None:
        """Note a level."""
        values: dict[Hashable, Array] = {}
        bars: dict[Hashable, float | None] = {}
        for key, row, value in _all(result):
            values[key] = np.atleast_1d(np.asarray(value, dtype=np.float64))
            bars[key] = row["total"]
        self.values.append(values)
        self.bars.append(bars)

    def is_beyond(self, key: Hashable) -> bool:
        """Whether the last move is larger than both bars: then neither is to be believed yet."""
        moves, bars = self._moves(key, 1), self._bars(key, 2)
        return bool(moves and bars and _size(moves[-1]) > sum(bars))

    def runs_away(self, key: Hashable) -> bool:
        """Whether it goes on by about as much with every mesh."""
        moves, bars = self._moves(key, 2), self._bars(key, 3)
        if not (moves and bars):
            return False
        sizes = [_size(move) for move in moves]
        if all(size > a + b for size, a, b in zip(sizes, bars, bars[1:], strict=False)):
            return bool(moves[0] @ moves[1] > 0 and sizes[1] > _BEYOND_BARS * sizes[0])
        moves, bars = self._moves(key, 3), self._bars(key, 4)
        if not (moves and bars):
            return False
        sizes = [_size(move) for move in moves]
        return (
            all(a @ b > 0 for a, b in pairwise(moves))
            and all(b > _STEADY * a for a, b in pairwise(sizes))
            and bars[-1] > _STEADY * bars[0]
            and sizes[-1] > _SMALL * bars[-1]
        )

    def runaways(self) -> list[Hashable]:
        """All that run away."""
        return [key for key in self.values[-1] if self.runs_away(key)] if self.values else []

    def _moves(self, key: Hashable, number: int) -> list[Array]:
        """The last moves, or none where there are not so many."""
        found = [level[key] for level in self.values[-number - 1 :] if key in level]
        if len(found) <= number:
            return []
        return [after - before for before, after in pairwise(found)]

    def _bars(self, key: Hashable, number: int) -> list[float]:
        """The last bars, or none where one of them is not known."""
        found = [bar for level in self.bars[-number:] if (bar := level.get(key)) is not None]
        return found if len(found) == number else []


def without_bars(result: Result, keys: Sequence[Hashable]) -> Result:
    """A result that claims no bars for quantities that run away, and says so."""
    if not keys:
        return result
    errors = {name: _stripped(row) if name in keys else row for name, row in result.errors.items()}
    contacts = []
    for number, contact in enumerate(result.contacts):
        rows = {
            name: _stripped(row) if (number, name) in keys else row
            for name, row in contact.errors.items()
        }
        contacts.append(dataclasses.replace(contact, errors=rows))
    supports = [_without_bar(row, number, keys) for number, row in enumerate(result.supports)]
    reactions = {name: _without_bar(row, name, keys) for name, row in result.reactions.items()}
    notes = [*result.error_notes, f"{said(keys, result)}, so there is no error bar."]
    return dataclasses.replace(
        result,
        errors=errors,
        contacts=contacts,
        supports=supports,
        reactions=reactions,
        error_notes=notes,
    )


def _without_bar(found: Held, of: int | str, keys: Sequence[Hashable]) -> Held:
    """Return a support, or supports of one name, without the error bars of unbounded reactions."""
    errors = {
        name: _stripped(row) if Reaction(of, name) in keys else row
        for name, row in found.errors.items()
    }
    return dataclasses.replace(found, errors=errors)


def said(keys: Sequence[Hashable], result: Result) -> str:
    """Return in words that quantities run away."""
    words = []
    for key in keys:
        if isinstance(key, Reaction):
            of = result.supports[key.of].name if isinstance(key.of, int) else key.of
            words.append(f"{key.quantity.replace('_', ' ')} of '{of}'")
            continue
        name = str(key[1] if isinstance(key, tuple) else key).replace("_", " ")
        of = f" of '{result.contacts[key[0]].name}'" if isinstance(key, tuple) else ""
        words.append(name + of)
    words = list(dict.fromkeys(words))
    listed = " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)
    verb = "do" if len(words) > 1 else "does"
    return (
        f"{listed} {verb} not converge: from mesh to mesh the change is as large as before, which "
        "is so where displacements are prescribed that jump, or nearly do"
    )


def _stripped(row: Mapping[str, float | None]) -> dict[str, float | None]:
    return {**row, "mesh": None, "total": None}


def _all(result: Result) -> list[tuple[Hashable, Mapping[str, float | None], QuantityValue]]:
    """Key, row of errors and value of every quantity."""
    found: list[tuple[Hashable, Mapping[str, float | None], QuantityValue]] = [
        (name, row, result.quantities[name]) for name, row in result.errors.items()
    ]
    for number, contact in enumerate(result.contacts):
        found += [
            ((number, name), row, contact.quantities[name]) for name, row in contact.errors.items()
        ]
    parts: list[tuple[int | str, SupportRecord | ReactionRecord]] = [
        *enumerate(result.supports),
        *result.reactions.items(),
    ]
    found += [
        (Reaction(of, name), row, part.quantities[name])
        for of, part in parts
        for name, row in part.errors.items()
    ]
    return [row for row in found if row[2] is not None]


def _size(move: Array) -> float:
    return float(np.linalg.norm(move))
