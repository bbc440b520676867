"""A boundary of the body that moves as a rigid body, by one scalar a way.

Its nodes have the displacement Σ q_j E_j, where E_j is a unit translation along an axis, or a
rotation about one by which the farthest node moves by about 1: so all q_j are lengths, and the
forces that do work on them are forces. With K of the body, ∂²W/∂u∂q_j = K E_j.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem

from fenics_contact.body.description import CoupledGroup, Joint
from fenics_contact.body.preloaded_part import ScalarForces
from fenics_contact.body.spaces import Spaces, summed_over_ranks, surface_integrals
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import largest, total
from fenics_contact.scene.loading.couplings import Way, ways_of
from fenics_contact.scene.values import AXES


class CoupledFace:
    """The boundary, and the ways in which it moves; collective.

    Attributes:
        described: As in the scene.
        at: The point that moves with it, (components,) (length).
        ways: In which it can move.
        reach: By which a rotation is multiplied to be a displacement (length).
        fields: Displacement of a unit of each way, 0 elsewhere, (ways, nodes, components).

    Args:
        described: As in the scene.
        key: Where, for messages.
        spaces: Those of the body.

    Raises:
        InputError: The group is no boundary, or has no area.
    """

    def __init__(self, described: CoupledGroup, key: str, spaces: Spaces) -> None:
        self.described, size = described, spaces.components
        group = spaces.body.boundary(described.on, f"{key}.on")
        nodes = spaces.nodes(group).astype(np.int64)
        measure = spaces.boundary(group, {"quadrature_degree": spaces.bulk_degree + 2})
        area, *moments = surface_integrals(spaces.position, measure, spaces)
        if not area > 0:
            raise InputError(f"{key}.on = '{described.on}': has no area")
        centroid = np.array(moments) / area
        self.at = centroid if described.at is None else np.array(described.at, float)
        arms = np.zeros((len(nodes), 3))
        arms[:, :size] = spaces.coordinates[nodes, :size] - self.at
        self.reach = largest(spaces.comm, np.linalg.norm(arms, axis=1)) or spaces.size
        self.ways: list[Way] = ways_of(spaces.kinematics)
        self.fields = np.zeros((len(self.ways), *spaces.coordinates[:, :size].shape))
        for field, (kind, axis) in zip(self.fields, self.ways, strict=True):
            unit = np.eye(3)[AXES.index(axis)]
            moved = unit if kind == "displacement" else np.cross(unit, arms) / self.reach
            field[nodes] = np.broadcast_to(moved, arms.shape)[:, :size]

    def amount(self, way: Way, value: float) -> float:
        """The scalar of a way from a displacement or a rotation (length, radian)."""
        return value if way[0] == "displacement" else value * self.reach

    def work(self, way: Way, value: float) -> float:
        """The force on the scalar of a way from a force or a moment."""
        return value if way[0] == "displacement" else value / self.reach


class Joints:
    """Springs between coupled faces, and between these and the ground, in scalars q of the body.

    A stop acts once its stretch is more than its gap, and then pushes the faces back. So the energy
    of all is ½ qᵀ K q of springs, and ½ ∑ k max(a · q − gap, 0)² of stops.

    Attributes:
        stiffness: K, (scalars, scalars) (force/length).

    Args:
        joints: What the scene says.
        faces: All that move; their ways are the last scalars.
        first: Number of scalars before these.
    """

    def __init__(self, joints: Sequence[Joint], faces: Sequence[CoupledFace], first: int) -> None:
        ways = [(face, way) for face in faces for way in face.ways]
        size = first + len(ways)
        self.stiffness = np.zeros((size, size))
        rows, stiff, gaps = [np.zeros((0, size))], list[float](), list[float]()
        for joint in joints:
            for way, stiffness in joint.stiffness:
                row, gap = np.zeros(size), dict(joint.gaps).get(way, 0.0)
                for number, sign in zip(joint.faces, (1.0, -1.0), strict=False):
                    face = faces[number]
                    row[first + ways.index((face, way))] = sign / face.amount(way, 1.0)
                if gap == 0:
                    self.stiffness += stiffness * np.outer(row, row)
                    continue
                rows.append(np.copysign(1.0, gap) * row[None])
                stiff.append(stiffness)
                gaps.append(abs(gap))
        self._rows, self._stiff, self._gaps = np.concatenate(rows), np.array(stiff), np.array(gaps)

    @property
    def has_stops(self) -> bool:
        """Whether some act only beyond a gap."""
        return len(self._gaps) > 0

    def _pressed(self, scalars: Array) -> Array:
        """Relative motion of each stop beyond its gap, 0 of open stops, (stops,) (length)."""
        return np.asarray(np.maximum(self._rows @ scalars - self._gaps, 0.0))

    def pull(self, scalars: Array) -> Array:
        """Forces by which all pull the scalars back, (scalars,) (force)."""
        return np.asarray(self.stiffness @ scalars + self.pull_of_stops(scalars))

    def pull_of_stops(self, scalars: Array) -> Array:
        """The part of stops in ``pull``."""
        return np.asarray(self._rows.T @ (self._stiff * self._pressed(scalars)))

    def tangent_of_stops(self, scalars: Array) -> Array:
        """Derivative of ``pull_of_stops`` in the scalars, (scalars, scalars)."""
        acting = np.where(self._pressed(scalars) > 0, self._stiff, 0.0)
        return np.asarray(self._rows.T @ (acting[:, None] * self._rows))

    def energy(self, scalars: Array) -> float:
        """Elastic energy of all springs and stops at a motion of the faces (energy)."""
        of_stops = self._stiff @ self._pressed(scalars) ** 2
        return 0.5 * float(scalars @ self.stiffness @ scalars + of_stops)


@dataclass(frozen=True, eq=False)
class MotionForces(ScalarForces):
    """Forces on the body by a unit motion of a coupled face, along one axis or about it.

    Attributes:
        moved: Displacement of the face, 0 elsewhere, (nodes, components).
        others: Present values of the body's other scalars, and their forces over these.
    """

    moved: Array
    others: list[tuple[fem.Constant, float]]

    def force(self, displacement: Array, mean_stress: Array) -> float:
        """∂W/∂q, from the displacement of all nodes, those of the face too (force); collective."""
        own = super().force(displacement, mean_stress)
        own -= self.stiffness * float(self.present.value)  # the displacement has it
        return own + sum(value * float(present.value) for present, value in self.others)


class MotionsOfFaces:
    """Finds what ways of coupled faces do to the body; collective.

    Args:
        spaces: Those of the body.
        stiffness: Its bilinear form, in UFL.
        mean_pressure: ∫ t tr(e(u)) of a mean stress that is an unknown, in UFL; None without one.
    """

    def __init__(self, spaces: Spaces, stiffness: ufl.Form, mean_pressure: ufl.Form | None) -> None:
        self._spaces = spaces
        self._unit = fem.Function(spaces.displacement_space)
        self._forces = form_cache.form(ufl.action(stiffness, self._unit))
        self._volumes = None
        if mean_pressure is not None:
            self._volumes = form_cache.form(ufl.action(mean_pressure, self._unit))

    def of(self, moved: Array) -> MotionForces:
        """Forces of a way on the body.

        Args:
            moved: Displacement of a unit of it, (nodes, components).
        """
        spaces = self._spaces
        self._unit.x.array[:] = moved.reshape(-1)
        nodal = spaces.assemble(self._forces)
        on_mean_stress, owned = np.zeros(0), 0
        if self._volumes is not None:
            vector = fem.assemble_vector(self._volumes)
            on_mean_stress = summed_over_ranks(vector.index_map, np.array(vector.array))
            owned = vector.index_map.size_local
        own = slice(spaces.owned_nodes)
        stiffness = float(total(spaces.comm, float(np.sum(nodal[own] * moved[own]))))
        present = fem.Constant(spaces.body.mesh, 0.0)
        return MotionForces(spaces, present, nodal, on_mean_stress, owned, stiffness, moved, [])
