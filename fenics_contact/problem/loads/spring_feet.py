"""The feet of the springs that hold a body: where a scene moves them, and what that does."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from dolfinx import fem

from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.body.spaces import Spaces
from fenics_contact.body.springs import Springs
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.scene.loading.load_paths import KeyedPath
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.values import Value


class SpringFoot:
    """The foot of the springs of a support, with its path; collective.

    Attributes:
        springs: The springs.
        label: Name of the support in results.
        path: How the foot moves over the load steps.
        displacement: ū at present, (nodes, components) (length).
        load: ∫ k ū φ at present, likewise (force).

    Args:
        springs: The springs.
        scene: Of which their support is.
        spaces: Those of the body.
    """

    def __init__(self, springs: Springs, scene: Scene, spaces: Spaces) -> None:
        self.springs, self._spaces = springs, spaces
        support, key = scene.support[springs.support], f"support[{springs.support}]"
        self.label = support.label
        self.path: Callable[[float], float] = KeyedPath(support.path, f"{key}.path")
        self._whole = np.zeros((len(spaces.coordinates), spaces.components))
        for name, (way, value) in support.feet(spaces.components).items():
            self._whole += self.moved(way, value, f"{key}.{name}")
        self._load = springs.pull(self._whole)
        self.displacement, self.load = self._whole, self._load
        self._besides = np.zeros_like(self._whole)

    def moved(self, way: int, value: Value, key: str) -> Array:
        """A displacement of the foot along one direction, (nodes, components); collective (length).

        Args:
            way: Number of the direction.
            value: As a scene gives it.
            key: Where, for messages.
        """
        nodes = self._spaces.nodes(self.springs.group)
        found = np.zeros((len(self._spaces.coordinates), self._spaces.components))
        amounts = self._spaces.evaluate(value, nodes, key)
        found[nodes] = amounts[:, None] * self.springs.along(nodes)[way]
        return found

    def set_time(self, time: float, besides: Array) -> None:
        """Move the foot to a pseudo-time.

        Args:
            time: The pseudo-time.
            besides: Forces over pseudo-time besides those of the stretch, (nodes, components).
        """
        share = self.path(time)
        self.displacement, self.load = share * self._whole, share * self._load
        self._besides = time * besides

    def forces(self, displacement: Array) -> Array:
        """Forces ∫ k (ū − u) φ of the springs on the body, (nodes, components); collective (force).

        Args:
            displacement: u at the nodes of this rank, likewise (length).
        """
        return self.load - self.springs.pull(displacement) + self._besides

    def energy(self, displacement: Array) -> float:
        """½ ∫ k (u − ū)² of a displacement; collective (energy).

        What forces besides those of the stretch add counts at first order.
        """
        own = slice(self._spaces.owned_nodes)
        pull = self.forces(displacement) + self._besides
        stretch = self.displacement - displacement
        return 0.5 * float(total(self._spaces.comm, np.sum(stretch[own] * pull[own])))

    @property
    def form(self) -> fem.Form:
        """Linear form of the forces that stretch the springs, compiled."""
        return self.springs.form

    def mean(self, displacement: Array) -> list[float | None]:
        """Mean of a displacement over the surface, by component; None where no spring acts.

        All components where the springs have directions of their own.
        """
        if self.springs.directions is not None:
            return list(self.springs.mean(displacement))
        own = slice(self._spaces.owned_nodes)
        pulled = self.springs.pull(displacement)[own].sum(axis=0)
        whole = self.springs.stiffness * self.springs.area
        sums = total(self._spaces.comm, pulled)
        return [float(s / k) if k > 0 else None for s, k in zip(sums, whole, strict=True)]


class SpringFeet(list[SpringFoot]):
    """The feet of all elastic supports, in the order of these; collective.

    Attributes:
        load: ∫ k ū φ of all springs at present, (nodes, components) (force).
        disturbance: Forces of the springs of each over pseudo-time besides those of their stretch,
            a part of ``Problem.disturbance``, (nodes, components) each; or none.

    Args:
        elastic: The body with its springs.
        scene: Of which the supports are.
        spaces: Those of the body.
    """

    def __init__(self, elastic: ElasticBody, scene: Scene, spaces: Spaces) -> None:
        super().__init__(SpringFoot(each, scene, spaces) for each in elastic.springs)
        self._elastic, self._size = elastic, spaces.size
        self.load = np.zeros((len(spaces.coordinates), spaces.components))
        self.disturbance: list[Array] = []

    def set_time(self, time: float) -> None:
        """Move all feet to a pseudo-time."""
        self.load = np.zeros_like(self.load)
        besides = self.disturbance or [np.zeros_like(self.load)] * len(self)
        for foot, more in zip(self, besides, strict=True):
            foot.set_time(time, more)
            self.load += foot.load

    @property
    def applied(self) -> Array:
        """Sizes of the forces at the nodes that an imbalance is small against (force).

        The body gives way as well, so that it feels less of them than a body that is held.
        """
        found = np.zeros_like(self.load)
        for foot in self:
            relative = foot.springs.stiffness.max() * self._size / self._elastic.reference_modulus
            found += np.abs(foot.load) / (1 + relative)
        return found
