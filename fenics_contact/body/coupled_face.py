"""A boundary of the body that moves with a point, by one scalar q_j a way in which the point moves.

The nodes of a rigid one have the displacement Σ q_j E_j, where E_j is a unit translation along an
axis, or a rotation about one by which the farthest node moves by about 1: so all q_j are lengths,
and the forces that do work on them are forces. With K of the body, ∂²W/∂u∂q_j = K E_j.

One that stays elastic takes a unit force on q_j as the traction t_j = a + b × (x − c), linear in
the place. So its point has the mean motion C_j u = ∫ t_j · u. The force between point and boundary
is κ m_j of another scalar m_j, a length by the choice of κ, whose energy is κ m_j (q_j − C_j u).
"""

from __future__ import annotations

from collections.abc import Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fenics_contact.body.cyclic.coupled_points import axis_of_point
from fenics_contact.body.cyclic.cut_faces import CutFaces
from fenics_contact.body.description import CoupledGroup, Joint
from fenics_contact.body.preloaded_part import ScalarForces
from fenics_contact.body.spaces import Spaces, summed_over_ranks, surface_integrals
from fenics_contact.body.supports import HeldDofs
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import largest, total
from fenics_contact.scene.loading.couplings import Way, ways_of
from fenics_contact.scene.values import AXES, AxisName


class CoupledFace:
    """The boundary, and the ways in which its point moves; collective.

    Attributes:
        described: As in the scene.
        spaces: Those of the body.
        nodes: Of the boundary (local indices, owned and ghost).
        at: The point that moves with it, (components,) (length).
        ways: In which it can move.
        reach: By which a rotation is multiplied to be a displacement (length).
        fields: Displacement of a unit of each way, 0 elsewhere, (ways, nodes, components).
        size: Its area, over the thickness or the whole ring as for loads.
        centroid: Of the boundary and of its images that have the same point, (components,)
            (length).
        barred: Ways that symmetry keeps at 0, as the boundary and its images have one point.
        along: The axis of a ring that the point is on, of which the body is a sector; None
            elsewhere.

    Args:
        described: As in the scene.
        key: Where, for messages.
        spaces: Those of the body.
        held: Planes of symmetry.
        cut: The cut faces of a sector, or None.

    Raises:
        InputError: The group is no boundary, or has no area, or cannot move so in a sector.
    """

    def __init__(
        self,
        described: CoupledGroup,
        key: str,
        spaces: Spaces,
        held: HeldDofs,
        cut: CutFaces | None,
    ) -> None:
        self.described, self.spaces, size = described, spaces, spaces.components
        group = spaces.body.boundary(described.on, f"{key}.on")
        nodes = self.nodes = spaces.nodes(group).astype(np.int64)
        self.measure = spaces.boundary(group, {"quadrature_degree": spaces.bulk_degree + 2})
        area, *moments = surface_integrals(spaces.position, self.measure, spaces)
        if not area > 0:
            raise InputError(f"{key}.on = '{described.on}': has no area")
        self.size, self.centroid = float(area), np.array(moments) / area
        self.at = self.centroid if described.at is None else np.array(described.at, float)
        arms = np.zeros((len(nodes), 3))
        arms[:, :size] = spaces.coordinates[nodes, :size] - self.at
        self.reach = largest(spaces.comm, np.linalg.norm(arms, axis=1)) or spaces.size
        self.ways: list[Way] = ways_of(spaces.kinematics)
        self.fields = np.zeros((len(self.ways), *spaces.coordinates[:, :size].shape))
        for field, (kind, axis) in zip(self.fields, self.ways, strict=True):
            unit = np.eye(3)[AXES.index(axis)]
            moved = unit if kind == "displacement" else np.cross(unit, arms) / self.reach
            field[nodes] = np.broadcast_to(moved, arms.shape)[:, :size]
        mirrored = {AXES[axis] for axis in held.reached_planes(nodes)}
        self.barred = {way for way in self.ways if _is_mirrored(way, mirrored)}
        self.along: AxisName | None = None
        if cut is not None:
            self.along = axis_of_point(cut, described, key, self.at, nodes)
        if cut is not None and self.along is not None:
            self.barred |= {way for way in self.ways if way[1] != self.along}
            self.centroid = cut.on_axis(self.centroid)
            self.fields = np.array([cut.followed(field) for field in self.fields])

    def amount(self, way: Way, value: float) -> float:
        """The scalar of a way from a displacement or a rotation (length, radian)."""
        return value if way[0] == "displacement" else value * self.reach

    def work(self, way: Way, value: float) -> float:
        """The force on the scalar of a way from a force or a moment."""
        return value if way[0] == "displacement" else value / self.reach


def _is_mirrored(way: Way, mirrored: AbstractSet[AxisName]) -> bool:
    """Whether a way is kept at 0 by planes of symmetry across some axes."""
    kind, axis = way
    return axis in mirrored if kind == "displacement" else bool(mirrored - {axis})


# Of the largest moment of inertia of a surface: it is as thin as a line.
_LINE = 1e-10


class SpreadForces:
    """How a boundary that stays elastic takes forces and moments on its point; collective.

    Attributes:
        tractions: a of t_j = a + B (x − c) for a unit force on each way, and B, in this order.
        nodal: Its nodal forces, (ways, nodes, components).

    Args:
        face: The boundary, and the ways of its point.
        key: Where, for messages.
        spaces: Those of the body.

    Raises:
        InputError: The boundary is as thin as a line, about which no traction turns it.
    """

    def __init__(self, face: CoupledFace, key: str, spaces: Spaces) -> None:
        self._spaces, self._face, size = spaces, face, spaces.components
        mesh = spaces.body.mesh
        self._uniform = fem.Constant(mesh, np.zeros(size))
        self._linear = fem.Constant(mesh, np.zeros((size, size)))
        test = ufl.TestFunction(spaces.displacement_space)
        self._form = form_cache.form(self._work(self._uniform, self._linear, test))
        # Moments that images of the boundary take away are those of symmetry.
        ways = [way for way in face.ways if way not in face.barred]
        turns = [AXES.index(axis) for kind, axis in ways if kind == "rotation"]
        matrices = [_turn(axis)[:size, :size] for axis in turns]
        turned = [self._assembled(np.zeros(size), one) for one in matrices]
        about = self._inverse(turned, matrices, key)
        linear = np.einsum("kl,lij->kij", about, np.reshape(matrices, (len(turns), size, size)))
        arm = np.zeros(3)
        arm[:size] = face.at - face.centroid
        self.tractions: list[tuple[Array, Array]] = []
        for kind, axis in face.ways:
            number = AXES.index(axis)
            moment = np.cross(arm, np.eye(3)[number])[turns]
            uniform, by_moment = np.eye(3)[number, :size] / face.size, linear
            if kind == "rotation":
                moment, uniform = np.array([float(number == t) for t in turns]), np.zeros(size)
                by_moment = linear * face.reach
            self.tractions.append((uniform, np.tensordot(moment, by_moment, 1)))
        self.nodal = np.array([self._assembled(*one) for one in self.tractions])

    def work_of(self, way: Way, force: Expr, test: Expr) -> ufl.Form:
        """∫ t · v of the traction of a force on a way, in UFL (energy).

        Args:
            way: Along or about which axis.
            force: Of any size, in UFL (force).
            test: v.
        """
        mesh = self._spaces.body.mesh
        uniform, linear = self.tractions[self._face.ways.index(way)]
        traction = fem.Constant(mesh, uniform), fem.Constant(mesh, linear)
        return force * self._work(*traction, test)

    def _work(self, uniform: Expr, linear: Expr, test: Expr) -> ufl.Form:
        """∫ (a + B (x − c)) · v in UFL."""
        face, place = self._face, self._spaces.position
        centre = fem.Constant(self._spaces.body.mesh, face.centroid)
        traction = uniform + ufl.dot(linear, place - centre)
        return self._spaces.weight * ufl.dot(traction, test) * face.measure

    def _assembled(self, uniform: Array, linear: Array) -> Array:
        """Nodal forces of a traction, (nodes, components)."""
        self._uniform.value[:], self._linear.value[:] = uniform, linear
        return self._spaces.assemble(self._form)

    def _inverse(self, turned: Sequence[Array], matrices: Sequence[Array], key: str) -> Array:
        """Inverse of ∫ (r² 1 − r rᵀ), r = x − c, about the axes that count, (axes, axes).

        Args:
            turned: Nodal forces of the tractions e × r, (nodes, components) each.
            matrices: Of e × r, (components, components) each.
            key: Where, for messages.

        Raises:
            InputError: It is singular.
        """
        spaces = self._spaces
        if not matrices:
            return np.zeros((0, 0))
        own = slice(spaces.owned_nodes)
        arms = spaces.coordinates[own, : spaces.components] - self._face.centroid
        fields = [arms @ one.T for one in matrices]
        works = [[float(np.sum(f[own] * field)) for field in fields] for f in turned]
        second = np.asarray(total(spaces.comm, np.array(works)))
        if np.linalg.eigvalsh((second + second.T) / 2)[0] <= _LINE * second.max():
            raise InputError(
                f"{key}.on = '{self._face.described.on}': is as thin as a line, about which no "
                "traction turns it; kind = 'rigid' would do"
            )
        return np.asarray(np.linalg.inv(second))


def _turn(axis: int) -> Array:
    """Matrix of e × r for the unit vector of an axis, (3, 3)."""
    return np.asarray(np.cross(np.eye(3)[axis], np.eye(3)).T)


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
    """

    moved: Array

    def force(self, displacement: Array, mean_stress: Array) -> float:
        """∂W/∂q, from the displacement of all nodes, those of the face too (force); collective."""
        own = super().force(displacement, mean_stress)
        return own - self.stiffness * float(self.present.value)  # the displacement has it


@dataclass(frozen=True, eq=False)
class PointForces(ScalarForces):
    """Of the motion q_j of a boundary's point that stays elastic, or of the force between both.

    Attributes:
        moved: 0, as it moves no node by itself, (nodes, components).
        partner: The present value of the other one of the two.
        tie: κ, the second derivative of their energy in both (force/length).
    """

    moved: Array
    partner: fem.Constant
    tie: float

    def force(self, displacement: Array, mean_stress: Array) -> float:
        """The force that does work on it, from the displacement of all nodes; collective."""
        own = super().force(displacement, mean_stress)
        return own + self.tie * float(self.partner.value)

    def follow(self, others: Sequence[ScalarForces], shares: Array) -> None:
        """No other scalar of the body acts on it than its partner."""


def point_forces(
    face: CoupledFace, spread: SpreadForces, modulus: float, stresses: tuple[int, int]
) -> tuple[list[PointForces], list[PointForces]]:
    """Forces of the scalars m_j and q_j of a boundary that stays elastic.

    Args:
        face: The boundary.
        spread: How it takes forces on its point.
        modulus: Stiffness of the body (stress).
        stresses: Numbers of dofs of a mean stress of this rank, all and owned.
    """
    spaces = face.spaces
    tie = modulus * face.size / face.reach
    nothing, (every, owned) = np.zeros_like(spread.nodal[0]), stresses
    found: tuple[list[PointForces], list[PointForces]] = [], []
    for nodal in spread.nodal:
        pair = [fem.Constant(spaces.body.mesh, 0.0) for _ in range(2)]
        forces = (-tie * nodal, nothing)
        for of, one, other, force in zip(found, pair, reversed(pair), forces, strict=True):
            of.append(
                PointForces(
                    *(spaces, one, force, np.zeros(every), owned, 0.0, [], nothing, other, tie)
                )
            )
    return found


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

    @property
    def stresses(self) -> tuple[int, int]:
        """Numbers of dofs of a mean stress of this rank, all and owned; 0 without one."""
        if self._volumes is None:
            return 0, 0
        index_map = self._volumes.function_spaces[0].dofmap.index_map
        return int(index_map.size_local + index_map.num_ghosts), int(index_map.size_local)

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
        return MotionForces(spaces, present, nodal, on_mean_stress, owned, stiffness, [], moved)
