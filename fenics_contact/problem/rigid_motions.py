"""Rigid motions: those of bodies that the supports leave free, and those of obstacles."""

from __future__ import annotations

from functools import partial

import numpy as np

from fenics_contact.body.connected_parts import Parts
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import gather_rows, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.problem.existence.rigid_slip import motions_along, smooth_closing
from fenics_contact.problem.loads.couplings import CoupledMotions
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.values import AXES

# Of a jump: what the round-off of normals leaves along the surface.
_ROUND_OFF = 1e-12
# Share of a motion from which it is one; and is named: facets do not tell where an axis is exactly.
_TAKES_PART, _NAMED = 1e-6, 0.02
# Of a slip along several curved surfaces: what these, whose facets do not agree on the axis to turn
# about, make of it across.
_ALONG = 0.01


class RigidMotions:
    """Motions that do not strain the body as it is now, as columns of a common basis.

    Combinations of translations and rotations of each part of the body (scaled to its size) and
    of the obstacles that a force drives, each along its direction, or a moment turns, that leave
    supports and glue alone; each column is of as few of these as can be.

    Attributes:
        floating: The scalar unknowns of these obstacles.
        count: Number of columns.
        force: Work of the loads on each (force × length).
        force_size: The same with all contributions positive, for round-off.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._jumps: dict[ContactSurface, Array] = {}
        spaces = problem.spaces
        self.floating = [one for one in problem.unknowns if one.moves_obstacle and not one.own]
        cut = problem.discrete.cut
        about = None if cut is None else cut.centre
        self._names, self._fields = problem.discrete.once(
            "rigid motions", partial(_of_parts, spaces, about)
        )
        self._faces = CoupledMotions(problem.body_scalars, problem.elastic, spaces, self._fields)
        free = self._kept_combinations()
        self._body = free[: self._fields.shape[-1]]
        self._obstacles = free[self._fields.shape[-1] :]
        self.count = free.shape[1]
        force, size = self._work(problem.load)
        driven = np.array([one.force for one in self.floating])
        force = force + self._faces.work
        self.force = force @ self._body + driven @ self._obstacles
        size = size + np.abs(self._faces.work)
        self.force_size = float(max(size.max(initial=0.0), np.abs(driven).max(initial=0.0)))

    def _work(self, nodal: Array) -> tuple[Array, Array]:
        """Work of nodal forces on each field, and with all contributions positive; collective."""
        work, size = np.zeros((2, self._fields.shape[-1]))
        if self.count:
            owned = nodal[: self._problem.spaces.owned_nodes]
            acting = np.flatnonzero(owned.any(axis=1))  # mostly few: those of surfaces
            each = owned[acting, :, None] * self._fields[acting]
            work = total(self._problem.comm, each.sum(axis=(0, 1)))
            size = total(self._problem.comm, np.abs(each).sum(axis=(0, 1)))
        work[np.abs(work) <= 1e-12 * size] = 0.0
        return work, size

    def work_of(self, nodal: Array) -> Array:
        """Work of nodal forces on the body in each motion, (count,); collective (force × length).

        Args:
            nodal: (nodes, components) (force).
        """
        return np.asarray(self._work(nodal)[0] @ self._body)

    @property
    def parts(self) -> Parts:
        """The connected parts of the body."""
        return self._problem.spaces.parts

    @property
    def body_is_held(self) -> bool:
        """Whether only obstacles are free."""
        return not np.abs(self._body).max(initial=0.0) > 1e-9

    @property
    def slides_on_coulomb(self) -> bool:
        """Whether friction of unknown bound resists a motion that no obstacle does; collective.

        Friction of a known bound may resist it, too: whether that is enough depends on the loads.
        """
        return self._slides(touching=False)

    @property
    def slides_where_it_touches(self) -> bool:
        """Whether friction resists a motion that no obstacle does before it has moved; collective.

        As that of a bolted plate, which its bolt stops only once the hole's clearance is used up.
        Only points count whose gap is closed before any motion.
        """
        return self._slides(touching=True)

    def _slides(self, touching: bool) -> bool:
        if self.count == 0:
            return False
        weights, normal, gap = self.closings()
        stops = gap <= 0 if touching else np.ones(len(gap), dtype=bool)
        weights, normal = weights[stops], normal[stops]
        across = np.einsum("q,qi,qj->ij", weights, normal, normal)
        w, slip = self.slips(coulomb=True, touching=touching)
        rough = np.asarray(total(self._problem.comm, np.einsum("q,qci,qcj->ij", w, slip, slip)))
        loose, _ = motions_along(across, _ALONG**2 * rough)
        loose /= np.linalg.norm(loose, axis=0)
        return bool(np.trace(loose.T @ rough @ loose) > _ROUND_OFF * np.trace(rough))

    def _kept_combinations(self) -> Array:
        """A basis of ``_free_combinations``; worked out once, but for glue and stabilisation."""
        problem = self._problem
        held_otherwise = problem.constrained is not problem.discrete.constrained
        if held_otherwise or any(contact.normal.sticks for contact in problem.contacts):
            return reduced(self._free_combinations())
        floats = [one.name for one in self.floating]
        known = f"free motions, obstacles {floats}, faces {self._faces.given}"
        return problem.discrete.once(known, lambda: reduced(self._free_combinations()))

    def _free_combinations(self) -> Array:
        """Combinations (modes and obstacles, free) with no jump on supports and glue."""
        problem = self._problem
        components, owned = problem.spaces.components, problem.spaces.owned_nodes
        modes, floats = self._fields.shape[-1], len(self.floating)
        held = np.zeros(owned * components, dtype=bool)
        held[problem.constrained[problem.constrained < owned * components]] = True
        held[problem.coupled[problem.coupled < owned * components]] = False
        rows = self._fields[:owned].reshape(-1, modes)[held]
        rows = np.concatenate([rows, *_on_springs(problem, self._fields), self._faces.held])
        if problem.discrete.cut is not None:
            apart = problem.discrete.cut.jumps(self._fields)  # the same on every rank
            rows = np.concatenate([rows, apart if problem.comm.rank == 0 else apart[:0]])
        every = [np.hstack([rows, np.zeros((len(rows), floats))])]
        for contact in problem.contacts:
            if contact.normal.sticks:
                reached = contact.kinematics.reached[: len(contact.nodes)]
                moved = contact.kinematics.relative(self._fields)
                nodes = contact.trace.numbers[contact.owned_nodes & reached]
                jumps = np.concatenate([moved, self._of_obstacles(contact)], axis=-1)[nodes]
                every.append(jumps.reshape(-1, modes + floats))
        stacked = np.concatenate(every)
        return null_space(np.asarray(total(problem.comm, stacked.T @ stacked)))

    def jumps(self, contact: ContactSurface) -> Array:
        """Jumps at the points of a contact in each motion, (points, components, count)."""
        if contact not in self._jumps:
            moved = contact.kinematics.jumps_of_body(lambda: self._fields) @ self._body
            of_obstacles = self._of_obstacles(contact) @ self._obstacles
            self._jumps[contact] = moved + contact.trace.at_points(of_obstacles)
        return self._jumps[contact]

    def slips(self, coulomb: bool = False, touching: bool = False) -> tuple[Array, Array]:
        """Weights w g and slips (points, components, count) at this rank's friction points.

        Slips as friction feels them.

        Args:
            coulomb: Those of the contacts whose bound is not known, with weights w.
            touching: Only points whose gap is closed before any motion.
        """
        problem = self._problem
        components = problem.spaces.components
        weights, slips = [np.zeros(0)], [np.zeros((0, components, self.count))]
        for contact in problem.frictional:
            if contact.is_coulomb != coulomb:
                continue
            bound = np.ones_like(contact.friction_bound) if coulomb else contact.friction_bound
            moved = self.jumps(contact)
            tangential = np.stack(
                [contact.kinematics.tangential(moved[..., i]) for i in range(self.count)], axis=-1
            )
            tangential[np.abs(tangential) <= _ROUND_OFF * np.abs(moved).max(initial=0.0)] = 0.0
            counted = contact.trace.owned
            if touching:
                counted = counted & (self.gap(contact) <= 0)
            weights.append((contact.trace.weights * bound)[counted])
            slips.append(contact.friction.rule.metric.at_each(tangential)[counted])
        return np.concatenate(weights), np.concatenate(slips)

    def closings(self) -> tuple[Array, Array, Array]:
        """Where one-sided contacts can act, on all ranks; collective.

        Returns:
            Weights w (points,), normal jumps of the motions (points, count), > 0 closing,
            and gaps before any motion (points,).
        """
        rows = [np.zeros((0, self.count + 2))]
        for contact in self._problem.contacts:
            if not contact.is_one_sided:
                continue
            trace = contact.trace
            jumps, gap = self.jumps(contact), self.gap(contact)
            closing = np.einsum("ijk,ij->ik", jumps, trace.normals)
            acts = trace.owned & np.isfinite(gap) & contact.normal.can_press()
            closing = smooth_closing(contact, closing, jumps, acts)
            rows.append(np.column_stack([trace.weights, closing, gap])[acts])
        table = gather_rows(self._problem.comm, np.concatenate(rows))
        return table[:, 0], table[:, 1:-1], table[:, -1]

    def touching_closings(self) -> tuple[Array, Array]:
        """Weights w and normal jumps (points, 1, count), where Coulomb contacts touch, this rank.

        At the points whose slips are ``slips(coulomb=True, touching=True)``.
        """
        weights, closing = [np.zeros(0)], [np.zeros((0, 1, self.count))]
        for contact in self._problem.coulomb:
            normal = np.einsum("ijk,ij->ik", self.jumps(contact), contact.trace.normals)
            counted = contact.trace.owned & (self.gap(contact) <= 0)
            weights.append(contact.trace.weights[counted])
            closing.append(normal[counted][:, None])
        return np.concatenate(weights), np.concatenate(closing)

    @staticmethod
    def gap(contact: ContactSurface) -> Array:
        """Gaps at the points, the obstacle where it stands (length)."""
        kinematics = contact.kinematics
        return kinematics.gap + kinematics.normal(kinematics.motion_at_points)

    def _of_obstacles(self, contact: ContactSurface) -> Array:
        """Jumps at all nodes of a contact's surface that the obstacles' motions make."""
        size = len(contact.trace.all_nodes), self._problem.spaces.components
        moved = np.zeros((*size, len(self.floating)))
        for number, one in enumerate(self.floating):
            if one.contact is contact:
                moved[:, :, number] = -one.moved_field
        return moved

    def displacement(self, motion: Array) -> Array:
        """Nodal displacements of the body in a motion, (nodes, components)."""
        return np.asarray(self._fields @ (self._body @ motion))

    def parts_moved(self, motion: Array) -> list[str]:
        """Names of the parts of the body that take part in a motion."""
        shares = np.abs((self._body @ motion).reshape(self._problem.spaces.parts.count, -1))
        moved = shares.max(axis=1, initial=0.0) > _NAMED * np.abs(motion).max(initial=0.0)
        names = self._problem.spaces.parts.names
        return [name for name, moves in zip(names, moved, strict=True) if moves]

    def alone(self, parts: Flags) -> Array:
        """Combinations of the motions in which some parts of the body move alone, as columns.

        Args:
            parts: Which, (parts,).
        """
        others = np.repeat(~parts, len(self._names))
        resting = np.vstack([self._body[others], self._obstacles])
        return null_space(resting.T @ resting)

    def kind_of(self, motion: Array) -> tuple[str, float]:
        """Whether all that moves turns alike, or goes alike, and how fast.

        Returns:
            ``moment`` and the angular velocity, or ``force`` and the velocity, by which work of the
            motion is a moment or a force; an empty text and 1 where parts move differently.
        """
        parts = self._problem.spaces.parts
        shares = (self._body @ motion).reshape(parts.count, len(self._names))
        turns = np.array([kind == "rotation about" for kind, _ in self._names])
        moves = np.abs(shares).max(axis=1) > _TAKES_PART * np.abs(motion).max(initial=0.0)
        if not moves.any() or np.abs(self.of_floating(motion)).max(initial=0.0) > 0:
            return "", 1.0
        spins = (shares[:, turns] / parts.sizes[:, None])[moves]
        paths = shares[:, ~turns][moves]
        kind, speeds = ("moment", spins) if spins.any() else ("force", paths)
        speed = float(np.linalg.norm(speeds[0]))
        return (kind, speed) if np.allclose(speeds, speeds[0], atol=1e-6 * speed) else ("", 1.0)

    def of_floating(self, motion: Array) -> Array:
        """Values of ``floating`` in a motion (length)."""
        return np.asarray(self._obstacles @ motion)

    def describe(self, motion: Array) -> str:
        """A motion in words."""
        parts = self._problem.spaces.parts
        scale = np.abs(motion).max(initial=0.0) or 1.0
        words = []
        shares = (self._body @ motion).reshape(parts.count, len(self._names))
        for name, of_part in zip(parts.names, np.abs(shares) > _NAMED * scale, strict=True):
            for kind in ("translation along", "rotation about"):
                named = zip(self._names, of_part, strict=True)
                axes = [AXES[axis] for (k, axis), moves in named if k == kind and moves]
                if axes:
                    whose = f" of '{name}'" if parts.count > 1 else ""
                    words.append(f"{kind} {' and '.join(axes)}{whose}")
        for one, share in zip(self.floating, self.of_floating(motion), strict=True):
            if abs(share) > _NAMED * scale and one.contact is not None:
                what = "rotation of the obstacle" if one.turns else "the obstacle"
                words.append(f"{what} at '{one.contact.label}'")
        return ", ".join(words)


def _of_parts(spaces: Spaces, about: Array | None) -> tuple[list[tuple[str, int]], Array]:
    """Kinds and axes of motions, and those of each part as fields of the whole."""
    names, fields = rigid_fields(spaces, about)
    return names, apart(spaces.parts, fields)


def rigid_fields(spaces: Spaces, about: Array | None = None) -> tuple[list[tuple[str, int]], Array]:
    """Translations, then rotations of each part about its own centre, scaled to its size.

    Args:
        spaces: Those of the body.
        about: Another point to turn about, (3,) (length).

    Returns:
        Kind and axis of each, and their values at the nodes of this rank, of shape
        (nodes, components, modes).
    """
    parts = spaces.parts
    arms = parts.arms if about is None else spaces.coordinates - about
    offset = arms / parts.sizes[parts.of_node, None]
    names: list[tuple[str, int]] = []
    fields: list[Array] = []
    axes = range(spaces.components) if spaces.kinematics != "axisymmetric" else (1,)
    for axis in axes:
        field = np.zeros((len(offset), 3))
        field[:, axis] = 1.0
        fields.append(field)
        names.append(("translation along", axis))
    spins = {"3D": (0, 1, 2), "axisymmetric": ()}.get(spaces.kinematics, (2,))
    for axis in spins:
        fields.append(np.cross(np.eye(3)[axis], offset))
        names.append(("rotation about", axis))
    return names, np.stack(fields, axis=-1)[:, : spaces.components]


def apart(parts: Parts, fields: Array) -> Array:
    """Fields of shape (nodes, components, modes) on each part alone, zero on all others.

    Returns:
        Shape (nodes, components, parts × modes), the first part's modes first.
    """
    members = parts.of_node[:, None] == np.arange(parts.count)
    spread = members[:, None, :, None] * fields[:, :, None, :]
    return np.asarray(spread.reshape(*fields.shape[:2], parts.count * fields.shape[2]))


def is_part_free(problem: Problem) -> Flags:
    """Whether no support and no spring holds anything of a part, (parts,); collective."""
    spaces = problem.spaces
    owned = spaces.owned_nodes
    held = np.zeros(owned * spaces.components)
    held[problem.constrained[problem.constrained < held.size]] = 1.0
    for springs in problem.elastic.springs:
        nodes = spaces.nodes(springs.group)
        held.reshape(owned, -1)[nodes[nodes < owned]] = 1.0
    return np.asarray(spaces.parts.sums(held.reshape(owned, spaces.components).sum(axis=1)) == 0.0)


def held_by_points_alone(problem: Problem) -> bool:
    """Whether some rigid motion is held by points alone that faces follow in the mean; collective.

    The stiffness of the bulk is singular then, also with all contact dofs held; where bodies move
    their masses resist as well.
    """
    if problem.inertia.moves or not problem.elastic.ties:
        return False
    spaces = problem.spaces
    size, owned = spaces.components, spaces.owned_nodes
    _, fields = _of_parts(spaces, None)
    held = np.zeros(owned * size, dtype=bool)
    held[problem.constrained[problem.constrained < owned * size]] = True
    by_node = held.reshape(owned, size)
    for contact in problem.contacts:
        if contact.forces.terms:
            every = np.ones(len(contact.trace.all_nodes), dtype=bool)
            by_node |= contact.kinematics.reaches(every)[:owned, None]
    rows = [fields[:owned].reshape(owned * size, -1)[held], *_on_springs(problem, fields)]
    stacked = np.concatenate(rows)
    free = null_space(np.asarray(total(problem.comm, stacked.T @ stacked)))
    return int(free.shape[1]) > 0


def _on_springs(problem: Problem, fields: Array) -> list[Array]:
    """Motions of owned nodes along directions that springs hold, (rows, modes)."""
    found, owned = [], problem.spaces.owned_nodes
    for springs in problem.elastic.springs:
        nodes = problem.spaces.nodes(springs.group)
        own = nodes[nodes < owned]
        ways = springs.along(own)[springs.stiffness > 0]
        moved = np.einsum("dnc,ncm->dnm", ways, fields[own])
        found.append(moved.reshape(-1, fields.shape[-1]))
    return found


def null_space(gram: Array) -> Array:
    """Null space of a symmetric positive semi-definite matrix, as columns."""
    values, vectors = np.linalg.eigh(gram)
    null = values <= 1e-13 * max(values.max(initial=0.0), np.finfo(float).tiny)
    return vectors[:, null]


def reduced(columns: Array) -> Array:
    """Another basis of the span of orthonormal columns, each 1 in a row where the others are 0.

    Rows are chosen as by pivoted elimination, the largest first and of equal ones the first, so
    that the basis depends on the span alone, and names of motions come out short.
    """
    rest = columns.copy()
    pivots: list[int] = []
    for _ in range(columns.shape[1]):
        sizes = np.linalg.norm(rest, axis=1)
        pivots.append(int(np.flatnonzero(sizes >= (1 - 1e-6) * sizes.max())[0]))
        along = rest[pivots[-1]] / sizes[pivots[-1]]
        rest = rest - np.outer(rest @ along, along)
    basis = columns @ np.linalg.inv(columns[pivots])
    basis[np.abs(basis) <= _ROUND_OFF * np.abs(basis).max(initial=0.0)] = 0.0
    return np.asarray(basis[:, np.argsort(pivots)])
