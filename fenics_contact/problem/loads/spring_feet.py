"""The feet of the springs that hold a body: where a scene moves them, and what that does."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from dolfinx import fem

from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.body.spaces import Spaces
from fenics_contact.body.springs import GIVES_WAY, Springs
from fenics_contact.body.supports import AppliedSupport, Supports
from fenics_contact.common.arrays import AnyIntegers, Array, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import raise_together, total
from fenics_contact.scene.loading.load_paths import KeyedPath, knots
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

    def held_at(self, nodes: AnyIntegers) -> tuple[Array, Array]:
        """Directions along which springs act at nodes of this rank, and the foot's whole way there.

        Args:
            nodes: Of the surface.

        Returns:
            (nodes, directions, components), and (nodes, directions) (length).
        """
        along = self.springs.along(nodes)[self.springs.stiffness > 0].swapaxes(0, 1)
        return along, np.einsum("ndc,nc->nd", along, self._whole[nodes])

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

    def require_agreement(self, supports: Supports, scene: Scene, spaces: Spaces) -> None:
        """Springs that hold move no point elsewhere than what else holds it; collective.

        Raises:
            InputError: They do; on every rank.
        """
        holding = [foot for foot in self if foot.springs.holds]
        if not holding:
            return
        owners: list[AppliedSupport | SpringFoot] = [*supports.applied, *holding]
        rows, of, sizes = _disagreement(supports.applied, holding, spaces)
        error = None
        for time in sorted({*scene.load_steps.all_times, *knots(scene)}):
            shares = np.array([owner.path(scene.path_time(time)) for owner in owners])
            off, moved = np.abs(rows @ shares), np.abs(sizes * shares).max()
            if error is None and (off > _ALIKE * moved).any():
                one, other = (owners[number].label for number in of[int(off.argmax())])
                error = InputError(
                    f"support on '{one}': would move a point at time {time:g} to where '{other}', "
                    "which holds that point, too, does not let it go; let both move it alike, or "
                    "leave one of them out"
                )
        raise_together(spaces.comm, error)

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


# Of what is moved, by which two supports may move a point otherwise: what springs give way.
_ALIKE = GIVES_WAY


def _disagreement(
    rigid: Sequence[AppliedSupport], feet: Sequence[SpringFoot], spaces: Spaces
) -> tuple[Array, Integers, Array]:
    """Contradictions between supports that move the same points of this rank.

    They are linear in the load paths of the supports.

    Args:
        rigid: What holds dofs.
        feet: Of springs that hold.
        spaces: Those of the body.

    Returns:
        Rows over these two lists, for each row numbers of a foot and of another owner in them, and
        how far each moves any such point at most (length).
    """
    size = spaces.components
    owner_of = np.full(spaces.coordinates[:, :size].size, -1)
    value_of, sizes = np.zeros(len(owner_of)), np.zeros(len(rigid) + len(feet))
    for number, support in reversed(list(enumerate(rigid))):
        if not support.follows and len(support.values):
            owner_of[support.dofs], value_of[support.dofs] = number, support.values
    first, values = owner_of.reshape(-1, size), value_of.reshape(-1, size)
    every = [spaces.nodes(foot.springs.group) for foot in feet]
    nodes, count = np.unique(np.concatenate(every), return_counts=True)
    shared = nodes[(count > 1) | (first[nodes] >= 0).any(axis=1)]
    known = [
        (np.flatnonzero(np.isin(shared, one)), foot) for one, foot in zip(every, feet, strict=True)
    ]
    held = [(places, *foot.held_at(shared[places])) for places, foot in known]
    rows, of = [np.zeros((0, len(rigid) + len(feet)))], [np.zeros((0, 2), dtype=np.int64)]
    for place, node in enumerate(shared):
        axes = np.flatnonzero(first[node] >= 0)
        ways, given, owner = [np.eye(size)[axes]], [values[node][axes]], [first[node][axes]]
        for number, (places, along, moved) in enumerate(held, len(rigid)):
            for row in np.flatnonzero(places == place):
                ways.append(along[row])
                given.append(moved[row])
                owner.append(np.full(len(along[row]), number))
        all_ways, owners = np.concatenate(ways), np.concatenate(owner)
        by_owner = np.zeros((len(owners), len(rigid) + len(feet)))
        by_owner[np.arange(len(owners)), owners] = np.concatenate(given)
        sizes = np.maximum(sizes, np.abs(by_owner).max(axis=0))
        rows.append(by_owner - all_ways @ (np.linalg.pinv(all_ways) @ by_owner))
        of.append(np.tile([owners[-1], owners[0]], (len(owners), 1)))
    return np.concatenate(rows), np.concatenate(of), sizes
