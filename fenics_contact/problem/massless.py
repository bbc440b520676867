"""Masses of nodes without those that would hit obstacles: contact nodes have none across.

A node that hits with a mass of its own rebounds, in every step anew, and pressures ring. Without it
they follow from the elasticity behind, as in statics. Its mass across the contact is given to other
nodes of the same cells, so that the whole is kept (H. B. Khenous, P. Laborde and Y. Renard,
Eur. J. Mech. A 27 (2008) 918-932); along the contact the node keeps it.

Masses that move in a few modes alone: what is left of the body follows as in statics. With
M-orthonormal modes V the mass matrix becomes M V Vᵀ M. So the matrix of a step has the inverse R +
V (ω² + 4/Δt²)⁻¹ Vᵀ, where R is the flexibility of the body less that of the modes: the residual
flexibility of component mode synthesis (R. H. MacNeal, Comput. Struct. 1 (1971) 581-601). All that
has no mass, contacts among it, is in balance at the end of each step.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.surface.trace import Trace
from fenics_contact.quantities.names import LEFT_OUT_KINETIC_ENERGY

# Squared sine of the angle between normals of two contacts at a node, below which they are one.
_SAME_WAY = 1e-12


class ContactMasses:
    """Lumped masses of nodes, with none across contacts; collective.

    Attributes:
        in_matrix: Whether the matrix of a step has them.
        blocks: (nodes, components, components) (mass).

    Args:
        lumped: Of each node (mass).
        contacts: Of the problem.
        spaces: Of the body.
        held: What supports hold, (nodes, components); what these move keeps its mass.

    Raises:
        InputError: All nodes of the cells around a node touch something; on every rank.
    """

    in_matrix: ClassVar = True

    def __init__(
        self, lumped: Array, contacts: Sequence[ContactSurface], spaces: Spaces, held: Flags
    ) -> None:
        self._held = held
        self._across = _across_contacts(contacts, spaces, held)
        self._neighbours = _Neighbours(self._across, spaces)
        self.blocks = self._with_masses(lumped[:, None, None] * np.eye(spaces.components))

    def _with_masses(self, values: Array) -> Array:
        across = self._across @ values
        return np.asarray(values - across + self._neighbours.taken(across))

    def with_masses(self, load: Array) -> Array:
        """A load that acts on masses, such as a weight, where these are; collective.

        Args:
            load: At the nodes, (nodes, components) (force).
        """
        return self._with_masses(load[:, :, None])[:, :, 0]

    def split_forces(self, values: Array) -> tuple[Array, Array]:
        """Forces at nodes across contacts, which no mass answers, and what is left of them.

        Args:
            values: (nodes, components).
        """
        across = np.einsum("nij,nj->ni", self._across, values)
        return across, values - across

    split_motions = split_forces

    def needed(self, left: Array, pressed: Array, slowed: Array) -> Array:
        """Forces needed from contacts and supports, as ``StepForces.needed`` (force).

        Args:
            left: That, (nodes, components) (force).
            pressed: Forces of pressures at the end of the step (force).
            slowed: The mean deceleration; supports take nodes along by the mean velocity of the
                step (length/time²).
        """
        across, along = self.split_forces(left)
        _, shared = self.split_forces(pressed)
        return across + 0.5 * (along + shared) + np.where(self._held, self.times(slowed), 0.0)

    def quantities(self, velocity: Array) -> dict[str, float]:
        """Energy besides the kinetic: none, as all masses move."""
        return {}

    def times(self, values: Array) -> Array:
        """M times vectors at nodes.

        Args:
            values: (nodes, components), such as velocities for momenta.
        """
        return np.asarray(np.einsum("nij,nj->ni", self.blocks, values))


def _across_contacts(contacts: Sequence[ContactSurface], spaces: Spaces, held: Flags) -> Array:
    """Projection onto the normals of one-sided contacts at each node, 0 elsewhere; collective.

    Of two bodies that touch, of both: with masses on one side alone, lighter ones than in the body,
    pressures ring between them.

    Args:
        contacts: Of the problem.
        spaces: Of the body.
        held: What supports hold, which does not move across anything by itself.

    Returns:
        (nodes, components, components).
    """
    size = spaces.components
    found = np.zeros((len(spaces.coordinates), size, size))
    for contact in contacts:
        if not contact.is_one_sided:
            continue
        _add_normals(contact.trace, held, found)
        if contact.sides.opposite is not None:
            _add_normals(contact.sides.opposite, held, found)
    return found


def touching_nodes(contact: ContactSurface, spaces: Spaces) -> Flags:
    """Nodes of this rank that have a normal of a one-sided contact, (nodes,); collective."""
    none = np.zeros((len(spaces.coordinates), spaces.components), dtype=bool)
    return np.asarray(np.einsum("nii->n", _across_contacts([contact], spaces, none)) > 0)


def _add_normals(trace: Trace, held: Flags, found: Array) -> None:
    """Normals of a surface to projections at the body's nodes; collective."""
    at_nodes = trace.at_all_nodes(trace.normals[: len(trace.nodes)])
    normals = np.where(held, 0.0, trace.surface.on_body(at_nodes))
    new = normals - np.einsum("nij,nj->ni", found, normals)
    squares = np.einsum("ni,ni->n", new, new)
    other = squares > _SAME_WAY
    found[other] += new[other, :, None] * new[other, None, :] / squares[other, None, None]


class _Neighbours:
    """Who takes over what nodes in contact give away: the other nodes of their cells, alike.

    Args:
        across: As ``_across_contacts`` gives it.
        spaces: Of the body.

    Raises:
        InputError: All nodes of the cells around a node touch something; on every rank.
    """

    def __init__(self, across: Array, spaces: Spaces) -> None:
        self._spaces = spaces
        touches = np.einsum("nii->n", across) > 0
        topology = spaces.body.mesh.topology
        own = topology.index_map(topology.dim).size_local
        cells = spaces.displacement_space.dofmap.list[:own]
        gives = touches[cells]
        takes_part = gives.any(axis=1) & ~gives.all(axis=1)
        self._cells, self._gives = cells[takes_part], gives[takes_part]
        counts = np.zeros((len(touches), 1))
        np.add.at(counts[:, 0], self._cells[self._gives], 1.0)
        self._counts = spaces.summed(counts)[:, 0]
        stranded = touches & (self._counts == 0)
        if spaces.comm.allreduce(int(stranded.sum())):
            raise InputError(
                "all nodes of a cell are in contact, so that none is left to take their "
                "mass; use finer cells there"
            )

    def taken(self, given: Array) -> Array:
        """Values that nodes take over from neighbours in contact, which give theirs; collective.

        Args:
            given: Of each node, first axis nodes.
        """
        flat = given.reshape(len(given), math.prod(given.shape[1:]))
        share = flat / np.maximum(self._counts, 1.0)[:, None]  # of each node, for each of its cells
        gives = self._gives.astype(np.float64)
        in_cells = np.einsum("ck,ckj->cj", gives, share[self._cells])
        in_cells /= (~self._gives).sum(axis=1)[:, None]
        found = np.zeros_like(flat)
        rows, columns = np.nonzero(~self._gives)
        np.add.at(found, self._cells[rows, columns], in_cells[rows])
        return self._spaces.summed(found).reshape(given.shape)


# Vectors whose momenta are kept: those of a step, and the velocity at its begin.
_KNOWN = 4


@dataclass(frozen=True, eq=False)
class FreeModes:
    """Modes of a body that no contact touches, rigid motions first: Vᵀ M V = 1.

    Attributes:
        shapes: V at the nodes of this rank, (nodes, components, modes).
        forces: M V, likewise; 0 where supports hold.
        squares: ω² (modes,) (1/time²).
    """

    shapes: Array
    forces: Array
    squares: Array

    @property
    def rigid(self) -> int:
        """Number of rigid motions."""
        return int((self.squares == 0).sum())

    def first(self, elastic: int) -> FreeModes:
        """Rigid motions and so many of the others."""
        kept = slice(self.rigid + elastic)
        return FreeModes(self.shapes[..., kept], self.forces[..., kept], self.squares[kept])


class ModalMasses:
    """M V Vᵀ M in place of M; collective, as all its methods.

    Attributes:
        in_matrix: As of ``ContactMasses``: of few modes the matrix is that of statics.

    Args:
        masses: M.
        modes: V.
        held: What supports hold, (nodes, components).
        spaces: Of the body.
    """

    in_matrix: ClassVar = False

    def __init__(
        self, masses: ContactMasses, modes: FreeModes, held: Flags, spaces: Spaces
    ) -> None:
        self._masses, self._modes, self._held, self._spaces = masses, modes, held, spaces
        self._known: list[tuple[Array, Array]] = []  # of velocities, asked for in several places

    def with_masses(self, load: Array) -> Array:
        """A nodal load that acts where there is mass; see ``ContactMasses.with_masses``."""
        return self._masses.with_masses(load)

    def times(self, values: Array) -> Array:
        """Mass times vectors at nodes, (nodes, components)."""
        known = next((found for one, found in self._known if one is values), None)
        if known is None:
            known = self._modes.forces @ self._along(self._modes.forces, values)
            self._known = [*self._known[1 - _KNOWN :], (values, known)]
        return known

    def quantities(self, velocity: Array) -> dict[str, float]:
        """Kinetic energy of all that is not in the modes, which they take for none (energy).

        Args:
            velocity: Of the nodes, (nodes, components) (length/time).
        """
        own = slice(self._spaces.owned_nodes)
        moving = np.where(self._held, 0.0, self.split_motions(velocity)[0])
        work = np.sum(moving[own] * self._masses.times(moving)[own])
        return {LEFT_OUT_KINETIC_ENERGY: float(0.5 * total(self._spaces.comm, work))}

    def needed(self, left: Array, pressed: Array, slowed: Array) -> Array:
        """Forces needed from contacts and supports; what supports hold has no mass here.

        To supports the balance leaves twice their mean, with what presses there.
        """
        return np.where(self._held, 0.5 * (left + pressed), left)

    def split_forces(self, values: Array) -> tuple[Array, Array]:
        """Forces that nothing of mass answers, and those on modes and on supports.

        Args:
            values: (nodes, components).
        """
        inertial = self._modes.forces @ self._along(self._modes.shapes, values)
        inertial[self._held] = values[self._held]
        return values - inertial, inertial

    def split_motions(self, values: Array) -> tuple[Array, Array]:
        """Displacements or velocities of what has no mass, and those of the modes.

        Args:
            values: (nodes, components).
        """
        inertial = self._modes.shapes @ self._along(self._modes.forces, values)
        return values - inertial, inertial

    def _along(self, modes: Array, values: Array) -> Array:
        own = slice(self._spaces.owned_nodes)
        flat = modes[own].reshape(-1, modes.shape[2])
        return np.asarray(total(self._spaces.comm, values[own].reshape(-1) @ flat))
