"""The zone at the contacts, whose equations are stiff, nonlinear, few, and solved directly.

Slaves that follow masters which are slaves of other contacts, as in a seat or behind a plate. The
factor of the zone has K_c of every slave as if its master were held. Where the master is in the
zone itself, moving it alone would open the contact against 1/ε₁. So it carries its slaves with it:
with u = w + P u' in the zone, K_c acts on w alone, and the factor stays as sparse as it is. What
it then lacks is the stiffness of the slave's own body against being carried, which is none of
1/ε₁.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from dolfinx import la
from petsc4py import PETSc

from fenics_contact.common import mumps
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.errors import MachineError
from fenics_contact.common.parallel import total
from fenics_contact.common.petsc_options import ZONE_PREFIX
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.iterative.contact_matrix import ContactMatrix


class ContactZone:
    """Free displacements of nodes at contacts, and scalar unknowns.

    The penalty makes K + K_c as stiff as 1/ε₁ there, where no multigrid would follow; a sparse
    factor of the zone does, and grows with the surface alone.

    Attributes:
        places: Of its unknowns among those of this rank.

    Args:
        problem: The problem.
        stiffness: K with supports cleared.
        contacts: K_c.
        nodes: This rank's nodes in it, owned and ghost.
        springs: What that diagonal has too much, at this rank's dofs (force/length).
        scalars: How many scalar unknowns are in it: all of them, or none.
    """

    def __init__(
        self,
        problem: Problem,
        stiffness: PETSc.Mat,
        contacts: ContactMatrix,
        nodes: Flags,
        springs: Array,
        scalars: int,
    ) -> None:
        self._contacts = contacts
        own = scalars if problem.comm.rank == 0 else 0
        dofs = free_dofs(problem, nodes)
        owned = stiffness.getLocalSize()[0]
        self.places = np.concatenate([dofs, owned + np.arange(own)])
        rows = self._indices(stiffness, dofs)
        every = PETSc.IS().createStride(
            owned, stiffness.getOwnershipRange()[0], 1, comm=problem.comm
        )
        self._rows = stiffness.createSubMatrix(rows, every)
        inner = stiffness.createSubMatrix(rows, rows)
        self._dofs, self._springs = dofs, springs[dofs]
        diagonal = inner.getDiagonal()
        with diagonal as array:
            array -= self._springs
        inner.setDiagonal(diagonal)
        self._stiffness = _with_scalars(inner, own, scalars)
        self._unknowns = self._indices(contacts.matrix, self.places)
        self._added = contacts.matrix.createSubMatrix(self._unknowns, self._unknowns)
        self._added.zeroEntries()  # room for K_c only: it has values where a zone is moved
        self._stiffness.axpy(1.0, self._added, PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
        self._tangent = self._stiffness.duplicate(copy=True)
        self._solved, self._right = self._stiffness.createVecs()
        self._image = self._rows.createVecLeft()
        self._factor = self._create_factor(mumps.SPARE_WORKSPACE[0])
        for thing in (rows, every, inner, diagonal):
            thing.destroy()

    def _indices(self, matrix: PETSc.Mat, local: Integers) -> PETSc.IS:
        rows = (matrix.getOwnershipRange()[0] + local).astype(PETSc.IntType)
        return PETSc.IS().createGeneral(rows, comm=matrix.comm)

    def _create_factor(self, spare: int) -> PETSc.PC:
        factor = PETSc.PC().create(self._tangent.comm)
        factor.setOptionsPrefix(ZONE_PREFIX)
        factor.setOperators(self._tangent)
        factor.setType("lu")
        factor.setFactorSolverType("mumps")
        factor.setFromOptions()
        if factor.getType() == "lu" and factor.getFactorSolverType() == "mumps":
            factor.setFactorSetUpSolverType()
            matrix = factor.getFactorMatrix()
            matrix.setOptionsPrefix(ZONE_PREFIX)
            matrix.setMumpsIcntl(14, spare)
        return factor

    def factorise(self) -> bool:
        """Factorise K + K_c in the zone, and say whether that went; collective.

        It does not where the zone is loose, as an obstacle under a force that nothing touches.

        Raises:
            MachineError: There is not enough memory; on every rank.
        """
        self._contacts.matrix.createSubMatrix(self._unknowns, self._unknowns, self._added)
        self._stiffness.copy(self._tangent, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        self._tangent.axpy(1.0, self._added, PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)
        self._factor.setOperators(self._tangent)
        self._factor.setUp()
        error = mumps.failure_of(self._factor)
        if isinstance(error, mumps.WorkspaceError):
            self._factor.destroy()
            self._factor, error = mumps.factorised(self._create_factor)
        if isinstance(error, MachineError):
            raise error
        return error is None

    def solve(self, right: Array) -> Array:
        """Unknowns that balance forces in the zone, all else held; collective."""
        with self._right as array:
            array[:] = right
        self._factor.apply(self._right, self._solved)
        return np.array(self._solved.array_r)

    def forces_inside(self, moved: Array) -> Array:
        """K times displacements of the zone, in the zone; collective."""
        with self._right as array:
            array[:] = moved
        self._stiffness.mult(self._right, self._solved)
        return np.array(self._solved.array_r)

    def forces_of_body(self, displacement: PETSc.Vec) -> Array:
        """K times displacements of the body, in the zone; collective."""
        self._rows.mult(displacement, self._image)
        found = np.zeros(len(self.places))
        found[: len(self._dofs)] = self._image.array_r
        found[: len(self._dofs)] -= self._springs * displacement.array_r[self._dofs]
        return found

    def destroy(self) -> None:
        """Free PETSc's objects."""
        for thing in (
            self._factor,
            self._rows,
            self._stiffness,
            self._tangent,
            self._added,
            self._unknowns,
            self._solved,
            self._right,
            self._image,
        ):
            thing.destroy()


def touching(problem: Problem) -> Flags:
    """Nodes of contact surfaces, slaves of pairs, where forces depend on displacements; collective.

    At present: what is open has none.
    """
    found = np.zeros(len(problem.spaces.coordinates), dtype=bool)
    for contact in (contact for contact in problem.contacts if contact.forces.terms):
        acts = contact.normal.acts(contact.pressure()) | (contact.friction.bound > 0)
        at_nodes = contact.trace.to_nodes(acts.astype(np.float64)) > 0
        whole = contact.trace.at_all_nodes(at_nodes).astype(np.float64)
        found |= contact.trace.surface.on_body(whole) > 0
    return found


def on_contacts(problem: Problem) -> Flags:
    """All nodes at which contacts that exert forces act, slaves of pairs; collective."""
    found = np.zeros(len(problem.spaces.coordinates), dtype=bool)
    for contact in (contact for contact in problem.contacts if contact.forces.terms):
        found |= slave_nodes(contact)
    return found


def slave_nodes(contact: ContactSurface) -> Flags:
    """The body's nodes at which a contact acts: of a slave those that face its master; collective.

    The others of its group may be masters of another contact, and are not to be in the zone then.
    """
    trace, pairing = contact.trace, contact.kinematics.pairing
    acts = np.ones(len(trace.all_nodes))
    if pairing is not None:
        acts[~pairing.faced] = 0.0
    return np.asarray(trace.surface.on_body(acts) > 0)


def masters(problem: Problem) -> Flags:
    """All nodes opposite to contacts between bodies that exert forces; collective."""
    found = np.zeros(len(problem.spaces.coordinates), dtype=bool)
    for contact in (contact for contact in problem.contacts if contact.forces.terms):
        pairing = contact.kinematics.pairing
        if pairing is not None:
            found |= pairing.master_nodes()
    return found


def beside(problem: Problem, nodes: Flags) -> Flags:
    """Nodes of all cells that have one of the nodes; collective."""
    dofmap = problem.spaces.displacement_space.dofmap
    marks = la.vector(dofmap.index_map, 1)
    marks.array[dofmap.list[nodes[dofmap.list].any(axis=1)]] = 1.0
    marks.scatter_reverse(la.InsertMode.add)
    marks.scatter_forward()
    return np.asarray(marks.array > 0)


def free_dofs(problem: Problem, nodes: Flags) -> Integers:
    """Owned dofs of nodes that nothing constrains."""
    spaces = problem.spaces
    owned = np.flatnonzero(nodes[: spaces.owned_nodes])
    dofs = owned[:, None] * spaces.components + np.arange(spaces.components)
    return np.setdiff1d(dofs.ravel(), problem.constrained)


def _with_scalars(matrix: PETSc.Mat, own: int, scalars: int) -> PETSc.Mat:
    """A matrix with empty rows and columns for the scalars, last on rank 0; collective."""
    first, columns, values = matrix.getValuesCSR()
    start = matrix.getOwnershipRangesColumn()[1]
    columns = np.where(columns >= start, columns + scalars, columns).astype(PETSc.IntType)
    first = np.concatenate([first, np.full(own, first[-1])]).astype(PETSc.IntType)
    size = matrix.getLocalSize()[0] + own
    sizes = ((size, PETSc.DETERMINE), (size, PETSc.DETERMINE))
    return PETSc.Mat().createAIJ(sizes, csr=(first, columns, values), comm=matrix.comm)


@dataclass(frozen=True, eq=False)
class _Links:
    """Links from contacts to those whose masters carry their slaves.

    Attributes:
        order: Numbers of the contacts whose slaves are carried, those first that carry others.
        refusal: Why that is not possible for all of them, empty where it is.
    """

    order: tuple[int, ...]
    refusal: str


class CarriedSlaves:
    """u = T y of displacements in the zone; collective, as all it has.

    Args:
        problem: The problem.
        contacts: Their tangents.
    """

    def __init__(self, problem: Problem, contacts: ContactMatrix) -> None:
        self._pairs = [contacts.pair_dofs(number) for number in _links(problem).order]

    @property
    def are_any(self) -> bool:
        """Whether T is not 1."""
        return bool(self._pairs)

    def carry(self, displacement: Array, inside: Flags) -> Array:
        """Product T y.

        Args:
            displacement: y of this rank's own dofs, 0 outside the zone.
            inside: Which of these are in the zone.
        """
        found = displacement.copy()
        for pair in self._pairs:
            _, opposite = pair.motions(found)
            found += np.where(inside, pair.on_body(opposite, None), 0.0)
        return found

    def collect(self, forces: Array, inside: Flags) -> Array:
        """Tᵀ f: forces on slaves also move what carries them.

        Args:
            forces: On this rank's own dofs, 0 outside the zone.
            inside: Which of these are in the zone.
        """
        found = forces.copy()
        for pair in reversed(self._pairs):
            given, _ = pair.motions(found)
            found += np.where(inside, pair.on_body(None, pair.handed_over(given)), 0.0)
        return found


def cannot_be_carried(problem: Problem) -> str:
    """Why the iterative solver is not for the contacts of a problem, empty if it is; collective."""
    return _links(problem).refusal


def _links(problem: Problem) -> _Links:
    """Links between contacts, by nodes that are free; collective."""
    contacts = {number: c for number, c in enumerate(problem.contacts) if c.forces.terms}
    slaves = {number: slave_nodes(contact) for number, contact in contacts.items()}
    masters = {
        number: contact.kinematics.pairing.faced_masters()
        for number, contact in contacts.items()
        if contact.kinematics.pairing is not None
    }
    owned = problem.spaces.owned_nodes
    free = problem.free.any(axis=1) if problem.free.ndim > 1 else problem.free

    def meet(one: Flags, other: Flags) -> bool:
        return bool(total(problem.comm, int((one & other & free)[:owned].sum())) > 0)

    carriers = {
        number: [other for other in contacts if other != number and meet(slaves[other], nodes)]
        for number, nodes in masters.items()
    }
    carried = [number for number, found in carriers.items() if found]
    order: list[int] = []
    while more := [
        number
        for number in carried
        if number not in order
        and all(other in order or other not in carried for other in carriers[number])
    ]:
        order += more
    ring = [number for number in carried if number not in order]
    twice = [
        number
        for number in order
        if any(other != number and meet(slaves[other], slaves[number]) for other in contacts)
    ]
    if ring:
        return _Links(tuple(order), _named(problem, ring, "are each other's masters in a ring"))
    if twice:
        words = "have slaves that other contacts share, and masters that are slaves themselves"
        return _Links(tuple(order), _named(problem, twice, words))
    return _Links(tuple(order), "")


def _named(problem: Problem, numbers: Sequence[int], words: str) -> str:
    names = ", ".join(f"'{problem.contacts[number].label}'" for number in numbers)
    return f"surfaces of the contacts {names} {words}"
