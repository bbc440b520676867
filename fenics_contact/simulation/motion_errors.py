"""Error bars of a motion, by motions with less of each error; each is solved from its begin.

How fast an error falls depends on what happens. What hits or begins to slide within a step is
known to the first order of the step, and the fronts of waves, which elements smear, to the order
½ of the cells; of smooth motions errors fall faster, and the bars are wider than need be.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from fenics_contact.body.spaces import Spaces
from fenics_contact.common.errors import FenicsContactError, MachineError
from fenics_contact.common.failures import attempt
from fenics_contact.common.timings import ESTIMATING, doing
from fenics_contact.mesh.refinement import is_of_order_1
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.problem.curved_sides import halved_body
from fenics_contact.quantities import table
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.record import Quantities
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.results.result import Result
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.motion import Motion
from fenics_contact.scene.scene import Scene
from fenics_contact.trust.error_estimates.budget import ErrorBudget, row_of
from fenics_contact.trust.error_estimates.measured import reactions

# The part of ε and of ε₁ that is left.
_LEFT = 1 / 32
#: Of the difference, for what is left: errors of first order, and not of the leading order alone.
FACTOR = 1 / (1 - _LEFT) ** 2


def with_reduced(scene: Scene, contacts: Sequence[ContactRecord], name: str) -> Scene | None:
    """A scene with a small part of ε or of ε₁; the same one where contacts have none.

    Args:
        scene: That was solved.
        contacts: With ε and ε₁ as used.
        name: ``penalty_parameter`` or ``regularisation_parameter``.

    Returns:
        None where it varies over a contact, so that no number stands for it.
    """

    def less(contact: Contact, record: ContactRecord) -> Contact:
        used = record.parameters.get(name)
        return replace(contact, **{name: _LEFT * used}) if used else contact

    if any(isinstance(record.parameters.get(name), str) for record in contacts):
        return None
    pairs = zip(scene.contact, contacts, strict=True)
    return replace(scene, contact=tuple(less(contact, record) for contact, record in pairs))


# Of a difference to half the step, and to cells of half the size with half the step: by their
# orders; and for what is not the leading order.
_OF_STEP, _OF_CELLS, _SAFETY = 2.0, 1 / (1 - 0.5**0.5), 1.25
_OF_MODES = 4.0
_LESS_TOLERANCE = 1e-2
_WORDS = {
    "mesh": "the mesh",
    "penalty": "the penalty",
    "regularisation": "the regularisation",
    "iteration": "the iterations",
    "step": "the time steps",
    "modes": "the free modes",
}

Again = Callable[[Scene, Body | None], Result]
Errors = dict[Hashable, float]


class NotHadError(FenicsContactError):
    """There is no such estimate."""


class MotionErrors:
    """Errors of the last step of a motion; collective.

    Args:
        scene: With the step that was taken.
        spaces: On its mesh.
        contacts: Of its result, with ε and ε₁ as used.
        last: What came out of its last step.
        again: Solves a motion.
    """

    def __init__(
        self,
        scene: Scene,
        spaces: Spaces,
        contacts: Sequence[ContactRecord],
        last: StepRecord,
        again: Again,
    ) -> None:
        self._spaces, self._body = spaces, spaces.body
        self._contacts, self._last, self._again = contacts, last, again
        settings = replace(scene.solver, errors="none")
        self._scene = replace(scene, solver=settings)
        self._answer = _values(last)

    def budget(self) -> ErrorBudget:
        """Return the errors of all quantities, by source."""
        sources: dict[str, Callable[[], Errors]] = {
            "mesh": self._by_mesh,
            "penalty": lambda: self._by_parameter("penalty_parameter"),
            "regularisation": lambda: self._by_parameter("regularisation_parameter"),
            "iteration": self._by_tolerance,
            "step": lambda: self._apart(self._with_half_the_step, self._body, _SAFETY * _OF_STEP),
        }
        if self._motion.modes is not None:
            sources["modes"] = self._by_modes
        found: dict[str, Errors | None] = {}
        notes: list[str] = []
        for source, estimate in sources.items():
            doing(f"{ESTIMATING} by {source}")
            missing = f"The error by {_WORDS[source]} was not estimated"
            had = partial(_if_it_fits, estimate)
            found[source] = attempt(self._spaces.comm, missing, had, None, notes)
        rows = {key: row_of(key, found) for key in self._answer}
        budget = ErrorBudget.of_rows(rows, len(self._contacts), len(self._last.supports))
        return replace(budget, notes=notes)

    @property
    def _motion(self) -> Motion:
        assert self._scene.motion is not None
        return self._scene.motion

    @property
    def _with_half_the_step(self) -> Scene:
        return replace(self._scene, motion=replace(self._motion, step=self._motion.size / 2))

    def _by_modes(self) -> Errors:
        """With twice as many; errors fall slowly with them, so all counts four times."""
        modes = self._motion.modes
        assert modes is not None and modes.number != "automatic"
        more = replace(self._motion, modes=replace(modes, number=2 * modes.number))
        return self._apart(replace(self._scene, motion=more), self._body, _OF_MODES)

    def _by_mesh(self) -> Errors:
        """With half the step as well: cells of half the size alone would be passed too fast."""
        if not is_of_order_1(self._body.mesh):
            raise NotHadError("cells with curved sides are not halved")
        return self._apart(self._with_half_the_step, halved_body(self._spaces), _SAFETY * _OF_CELLS)

    def _by_parameter(self, name: str) -> Errors:
        other = with_reduced(self._scene, self._contacts, name)
        if other is None:
            raise NotHadError("it varies over a contact")
        if other == self._scene:
            return {}
        return self._apart(other, self._body, FACTOR)

    def _by_tolerance(self) -> Errors:
        solver = self._scene.solver
        less = replace(solver, tolerance=_LESS_TOLERANCE * solver.tolerance)
        return self._apart(replace(self._scene, solver=less), self._body, 1.0)

    def _apart(self, scene: Scene, body: Body, factor: float) -> Errors:
        """How far another answer is from the one found, times a factor."""
        result = self._again(scene, body)
        if not result.converged:
            raise NotHadError("the motion with less of it did not converge")
        other = _values(result.steps[-1])
        return {
            key: factor * float(np.linalg.norm(np.subtract(value, other[key])))
            for key, value in self._answer.items()
            if key in other
        }


def _if_it_fits(estimate: Callable[[], Errors]) -> Errors:
    """An estimate; too large a one for the machine is none, though the motion itself fitted."""
    try:
        return estimate()
    except MachineError as error:
        raise NotHadError(str(error)) from error


def _values(step: StepRecord) -> dict[Hashable, Any]:
    """Return the values that have a true value, by the keys of budgets."""
    found: dict[Hashable, Any] = dict(_true(step.quantities).items())
    for number, contact in enumerate(step.contacts):
        found |= {(number, name): value for name, value in _true(contact.quantities).items()}
    return found | reactions(step.supports)


def _true(quantities: Quantities) -> dict[str, Any]:
    return {
        name: value
        for name, value in quantities.items()
        if value is not None
        and (name in table.with_true_value() or name.startswith("displacement_"))
    }
