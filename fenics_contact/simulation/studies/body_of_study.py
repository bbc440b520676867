"""The body that a study asks: kept from one scene to the next, made anew where it is another."""

from __future__ import annotations

import logging
from collections.abc import Sequence

from mpi4py import MPI

from fenics_contact.body.description import BodyDescription
from fenics_contact.common.timings import Timings
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.scene_mesh import mesh_of
from fenics_contact.simulation.studies.kept_body import KeptBody
from fenics_contact.solve.condensed.bulk.part_factors import KnownFactors

logger = logging.getLogger(__name__)


class BodyOfStudy:
    """The last body, and what the next one can take of it.

    Attributes:
        kept: The body, None before there is one.
        factors: Of the parts of the bodies so far.

    Args:
        comm: The ranks that it is on.
        mesh: That of all scenes; None: the one that each names.
    """

    def __init__(self, comm: MPI.Comm, mesh: Body | None) -> None:
        self.kept: KeptBody | None = None
        self._comm, self._mesh, self._own_mesh = comm, mesh, mesh is not None
        self._mesh_of: Sequence[object] = ()
        self.factors = KnownFactors()
        self._before = 0  # factorisations of bodies that are gone

    @property
    def factorisations(self) -> int:
        """How often a body was factorised."""
        return self._before + (0 if self.kept is None else self.kept.factorisations)

    def differences(self, scene: Scene, other: Scene) -> list[str]:
        """Return the names of the parts by which the bodies of two scenes differ."""
        found = list(BodyDescription.of(scene).differences(BodyDescription.of(other)))
        return found if self._same_mesh(mesh_key(scene), other) else ["mesh", *found]

    def of(self, scene: Scene, timings: Timings) -> KeptBody:
        """Return the body of a scene, built again if the last one was another; collective.

        Args:
            scene: The scene.
            timings: Seconds so far.
        """
        same_mesh = self._same_mesh(self._mesh_of, scene)
        if self.kept is not None:
            description = BodyDescription.of(scene)
            other = list(self.kept.discrete.description.differences(description))
            other += [] if same_mesh else ["mesh"]
            if not other:
                return self.kept
            logger.info("the body is made anew: other %s", ", ".join(other))
            self._before += self.kept.factorisations
            self.kept.close()
            self.kept = None
        if self._mesh is None or not same_mesh:
            self._mesh, self._mesh_of = mesh_of(scene, self._comm, timings), mesh_key(scene)
        self.kept = KeptBody(scene, self._mesh, timings, self.factors)
        return self.kept

    def _same_mesh(self, key: Sequence[object], scene: Scene) -> bool:
        return self._own_mesh or key == mesh_key(scene)

    def close(self) -> None:
        """Free the factorisation; the next answer makes another one."""
        if self.kept is not None:
            self.kept.close()
        self.factors.destroy()


def mesh_key(scene: Scene) -> Sequence[object]:
    """Return the part of a scene that its mesh depends on: files, and cuts for preloads."""
    return scene.mesh, [(p.on, p.axis, p.between) for p in scene.preload if p.between is not None]
