"""Error bars of the factor at which a part slips, where loads grow step by step to find it.

By answers with less of each error: on cells of half the size, with a small part of ε and of ε₁,
with a smaller tolerance. Between the largest loads that hold and the factor by the pressures with
these, it may be anywhere: that is the error by steps.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

from fenics_contact.body.spaces import Spaces
from fenics_contact.common.failures import attempt
from fenics_contact.common.timings import ESTIMATING, doing
from fenics_contact.mesh.refinement import is_of_order_1
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.problem.curved_sides import halved_body
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.result import Result
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.motion_errors import FACTOR, NotHadError, with_reduced
from fenics_contact.trust.slip_factor import SlipFactor

# Of a difference to half the cells: errors of first order, as beside edges of slip, and for what
# is not the leading order.
_OF_CELLS = 2.0 * 1.25
_LESS_TOLERANCE = 1e-2

Again = Callable[[Scene, Body, float | None], Result]


class SlipFactorErrors:
    """Errors of the factor; collective.

    Args:
        scene: That was solved.
        spaces: On its mesh.
        contacts: Of its result, with ε and ε₁ as used.
        found: The factor.
        again: Solves a scene on a mesh, with a factor of the loads that is tried first.
    """

    def __init__(
        self,
        scene: Scene,
        spaces: Spaces,
        contacts: Sequence[ContactRecord],
        found: SlipFactor,
        again: Again,
    ) -> None:
        self._scene = replace(scene, solver=replace(scene.solver, errors="none"))
        self._spaces, self._body, self._contacts = spaces, spaces.body, contacts
        self._found, self._again = found, again

    def row(self, notes: list[str]) -> dict[str, float | None]:
        """Return the errors by source.

        Args:
            notes: Gets sentences on what was not to be had.
        """
        sources: dict[str, Callable[[], float | None]] = {
            "mesh": self._by_mesh,
            "penalty": partial(self._by_parameter, "penalty_parameter"),
            "regularisation": partial(self._by_parameter, "regularisation_parameter"),
            "iteration": self._by_tolerance,
            "step": lambda: self._found.bracket,
        }
        row: dict[str, float | None] = {}
        for source, estimate in sources.items():
            doing(f"{ESTIMATING} by {source}")
            missing = f"The error of slip_factor by {source} was not estimated"
            row[source] = attempt(self._spaces.comm, missing, estimate, None, notes)
        known = [error for error in row.values() if error is not None]
        return {**row, "total": sum(known) if len(known) == len(row) else None}

    def _by_mesh(self) -> float | None:
        if not is_of_order_1(self._body.mesh):
            raise NotHadError("cells with curved sides are not halved")
        return self._apart(self._scene, halved_body(self._spaces), _OF_CELLS)

    def _by_parameter(self, name: str) -> float | None:
        other = with_reduced(self._scene, self._contacts, name)
        if other is None:
            return None
        return 0.0 if other == self._scene else self._apart(other, self._body, FACTOR)

    def _by_tolerance(self) -> float | None:
        solver = self._scene.solver
        less = replace(solver, tolerance=_LESS_TOLERANCE * solver.tolerance)
        return self._apart(replace(self._scene, solver=less), self._body, 1.0)

    def _apart(self, scene: Scene, body: Body, factor: float) -> float | None:
        """How far another answer is from the one found, times a factor; None without one."""
        limit = self._again(scene, body, self._found.loaded).slip_limit
        if limit is None or limit.factor is None or self._found.factor is None:
            return None
        if limit.kind == "upper bound":
            return None
        return factor * abs(limit.factor - self._found.factor)
