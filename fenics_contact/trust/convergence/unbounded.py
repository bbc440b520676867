"""Quantities that no mesh brings to an end: they have no error, and it is said why."""

from __future__ import annotations

from collections.abc import Hashable, Mapping

import numpy as np

from fenics_contact.problem.problem import Problem
from fenics_contact.quantities import table
from fenics_contact.quantities.names import FRICTION_FORCE, REACTION
from fenics_contact.quantities.quantity import Singular, Together
from fenics_contact.quantities.table import QuantityValue
from fenics_contact.scene.quantity_names import Reaction
from fenics_contact.solve.newton.solution import Solution
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
        return any(self._problem.contacts[number].has_unknown_position for number in jump.contacts)

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
        return f"reaction of '{supports[key.of].name if isinstance(key.of, int) else key.of}'"


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
