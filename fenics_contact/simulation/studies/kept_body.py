"""A body that is kept between answers: made ready once, condensed once, and found again."""

from __future__ import annotations

from fenics_contact.body.description import BodyDescription
from fenics_contact.common.timings import Timings
from fenics_contact.contact.slave_and_master import ContactSides
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.problem.discrete_body import DiscreteBody
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.scene import Scene
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.condensed_system import acting_sides


class KeptBody:
    """A body with its factorisation, for one problem after the other; collective.

    Attributes:
        discrete: The body made ready.
        factorisations: How often it was factorised.

    Args:
        scene: Any whose body it is.
        body: Its mesh.
        timings: Seconds so far.
    """

    def __init__(self, scene: Scene, body: Body, timings: Timings) -> None:
        with timings.phase("compile"):
            self.discrete = DiscreteBody(BodyDescription.of(scene), body)
        self.factorisations = 0
        self._condensed: CondensedBody | None = None

    def condense(self, problem: Problem, timings: Timings) -> CondensedBody:
        """The body condensed, as a problem needs it; collective.

        Again only where a surface is to carry forces that never did before, or where a
        stabilisation holds the body in another way.

        Args:
            problem: On this body.
            timings: Seconds so far.
        """
        sides, before = acting_sides(problem), self._condensed
        if before is not None:
            if before.serves(problem.constrained, sides):
                return before
            sides = self._with_earlier(sides, before)
            self.close()
        self._condensed = CondensedBody(self.discrete, problem.constrained, sides, timings)
        self.factorisations += 1
        return self._condensed

    def _with_earlier(self, sides: list[ContactSides], before: CondensedBody) -> list[ContactSides]:
        """Surfaces in scene order, with those that were condensed onto before."""
        chosen = {id(one) for one in (*sides, *before.sides)}
        return [one for one in self.discrete.sides if id(one) in chosen]

    def close(self) -> None:
        """Free the factorisation; the next answer makes another one."""
        if self._condensed is not None:
            self._condensed.destroy()
            self._condensed = None
