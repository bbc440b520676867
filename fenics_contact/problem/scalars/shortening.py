"""By how much the unstressed length of a preloaded part is shortened, as that of a tight bolt.

The force N along the part is the one that the scene asks for; or the part is locked, and keeps the
length that it has.
"""

from __future__ import annotations

import ufl

from fenics_contact.body.forms import Expr
from fenics_contact.body.preloaded_part import PreloadedPart, ScalarForces
from fenics_contact.problem.scalars.scalar import (
    BodyScalar,
    KnownProblem,
    ScalarState,
    ScalarUnknown,
)
from fenics_contact.results.records.contacts import PreloadRecord
from fenics_contact.scene.loading.conditions import Preload
from fenics_contact.scene.loading.load_paths import KeyedPath

# Of a pseudo-time, by which one is later than another.
_LATER = 1e-9


class Shortening(BodyScalar):
    """The shortening q of a preloaded part (length): N(u, q) = F, or as it was where it is locked.

    Attributes:
        scene: What the scene says.

    Args:
        preload: What the scene says.
        key: Its key in the scene, for messages.
        part: The part of the body.
        forces: What a unit of its shortening does to the body.
    """

    force_name = "force"

    def __init__(
        self, preload: Preload, key: str, part: PreloadedPart, forces: ScalarForces
    ) -> None:
        super().__init__(preload.label, forces)
        self.scene, self._part = preload, part
        self._path = KeyedPath(preload.path, f"{key}.path")
        self._force, self._is_locked = 0.0, False

    @property
    def name(self) -> str:
        """Its name in results."""
        return f"shortening of {self.label}"

    @property
    def term(self) -> str:
        """Name of the energy term that its force makes, for results."""
        return f"preload of {self.label}"

    @property
    def force(self) -> float:
        """The force that the part is tightened to at present (force)."""
        return self._force

    @property
    def has_force(self) -> bool:
        """Whether the scene tightens the part at any time."""
        return self.scene.force != 0

    @property
    def is_locked(self) -> bool:
        """Whether the unstressed length is kept at present."""
        return self._is_locked

    def set_time(self, time: float, more: float = 0.0) -> None:
        """Bring force and lock to a pseudo-time.

        Args:
            time: The pseudo-time.
            more: Force over pseudo-time besides the scene's.
        """
        locked = self.scene.locked_from
        self._is_locked = locked is not None and time > locked * (1 + _LATER)
        self._force = self.scene.force * self.force_factor(time)
        self._force += 0.0 if self.is_locked else more * time

    def force_factor(self, time: float) -> float:
        """Share of the scene's force that it is tightened to; 0 where it is locked."""
        return 0.0 if self.is_locked else self._path(time)

    def record(self, state: ScalarState) -> PreloadRecord:
        """What results have of the preload in an answer."""
        return PreloadRecord(
            on=self.scene.on,
            force=state.force,
            elongation=state.value,
            initial_strain=-state.value / self._part.length,
            locked=state.is_locked,
        )

    def force_of(self, stress: Expr) -> Expr:
        """The force along the part of a stress, (1/l) ∫ a · σ a, as a form in UFL, weighted."""
        strain = -self._part.stressless_strain(ufl.as_ufl(1.0))
        return self._part.spaces.weight * ufl.inner(stress, strain) * self._part.measure


def shortenings(problem: KnownProblem) -> list[ScalarUnknown]:
    """One for each preload of the scene, in its order."""
    elastic = problem.elastic
    known = zip(problem.scene.preload, elastic.preloaded, elastic.scalar_forces, strict=True)
    return [
        Shortening(preload, f"preload[{number}]", part, forces)
        for number, (preload, part, forces) in enumerate(known)
    ]
