"""K_c as a sparse matrix of all unknowns that is empty away from contacts and scalars.

What the master adds to K_c of a slave, applied: Jᵀ K_c J − K_c with the jump J u = u − P u'. Every
rank has the rows of its own nodes of both surfaces.

Between two bodies it is Jᵀ K_c J, which would be full, as the jump J u = u − P u' follows all of
the master. The matrix has K_c of the slave alone, as of an obstacle; P is applied beside it.
"""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.contact.mortar.pairing import Pairing
from fenics_contact.contact.surface.space import SurfaceSpace
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.systems.bordered_tangent import AddedTangents
from fenics_contact.solve.systems.bulk_matrix import preallocate_places, set_at_places
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix


class PairDofs:
    """This rank's own dofs of a slave and its master, and what P hands over between them.

    Args:
        slave: The surface of the slave.
        pairing: What faces what.
        body: A vector of the displacements' layout.
    """

    def __init__(self, slave: SurfaceSpace, pairing: Pairing, body: PETSc.Vec) -> None:
        self._pairing, self._components = pairing, slave.components
        self._body = body.duplicate()
        self._slave, self._of_slave = self._part(slave)
        self._master, self._of_master = self._part(pairing.master)

    def _part(self, surface: SurfaceSpace) -> tuple[PETSc.Vec, PETSc.Scatter]:
        """A vector of a surface's dofs, and what takes the body's there."""
        dofs: Integers = surface.own_dofs
        vector: PETSc.Vec = PETSc.Vec().createMPI((len(dofs), PETSc.DETERMINE), comm=surface.comm)
        places = PETSc.IS().createGeneral(dofs.astype(PETSc.IntType), comm=surface.comm)
        scatter = PETSc.Scatter().create(self._body, places, vector, None)
        places.destroy()
        return vector, scatter

    def slave_vector(self) -> PETSc.Vec:
        """A new vector of the slave's dofs."""
        return self._slave.duplicate()

    def motions(self, displacement: Array) -> tuple[Array, Array]:
        """The slave's displacements u and P u', at its own dofs; collective.

        Args:
            displacement: Of the dofs that this rank owns in the body, (owned,) (length).
        """
        with self._body as array:
            array[:] = displacement
        for vector, scatter in ((self._slave, self._of_slave), (self._master, self._of_master)):
            scatter.scatter(self._body, vector)
        moved = self._master.array_r.reshape(-1, self._components)
        return np.array(self._slave.array_r), self._pairing.projection.apply(moved).reshape(-1)

    def handed_over(self, forces: Array) -> Array:
        """Pᵀ f at own dofs of the master, of forces at those of the slave; collective."""
        nodal = forces.reshape(-1, self._components)
        return np.asarray(self._pairing.projection.transposed(nodal).reshape(-1))

    def on_body(self, at_slave: Array | None, at_master: Array | None) -> Array:
        """Values at own dofs of the surfaces, (owned,) of the body; collective.

        What several dofs of one place have adds up; None is nothing.
        """
        self._body.set(0.0)
        add, reverse = PETSc.InsertMode.ADD_VALUES, PETSc.ScatterMode.REVERSE
        for values, vector, scatter in (
            (at_slave, self._slave, self._of_slave),
            (at_master, self._master, self._of_master),
        ):
            if values is not None:
                with vector as array:
                    array[:] = values
                scatter.scatter(vector, self._body, add, reverse)
        return np.array(self._body.array_r)

    def destroy(self) -> None:
        """Free PETSc's objects."""
        for thing in (self._body, self._slave, self._of_slave, self._master, self._of_master):
            thing.destroy()


class PairMatrix:
    """The part of a contact between bodies that the matrix of the slave lacks.

    Attributes:
        dofs: Of both surfaces.

    Args:
        surface: K_c of the slave.
        pairing: What faces what.
        body: A vector of the displacements' layout.
    """

    def __init__(self, surface: SurfaceMatrix, pairing: Pairing, body: PETSc.Vec) -> None:
        slave = surface.contact.trace.surface
        owned = slave.owned_nodes * slave.components
        self._stiffness: PETSc.Mat = PETSc.Mat().createAIJ(
            ((owned, PETSc.DETERMINE), (owned, PETSc.DETERMINE)), comm=slave.comm
        )
        preallocate_places(self._stiffness, *surface.places)
        self.dofs = PairDofs(slave, pairing, body)
        self._jump, self._force = self.dofs.slave_vector(), self.dofs.slave_vector()

    def linearise(self, values: Array) -> None:
        """Take K_c, by the values of its entries on this rank; collective."""
        set_at_places(self._stiffness, values)

    def forces(self, displacement: Array) -> Array:
        """On the displacements that this rank owns in the body, (owned,); collective.

        Args:
            displacement: Likewise (length).
        """
        own, opposite = self.dofs.motions(displacement)
        reaction = -self.dofs.handed_over(self._times(self._stiffness, own - opposite))
        return self.dofs.on_body(self._times(self._stiffness, -opposite), reaction)

    def magnitudes(self, displacement: Array) -> Array:
        """Product with magnitudes of K_c, and of what P makes of its arguments; collective."""
        own, opposite = self.dofs.motions(displacement)
        opposite = np.abs(opposite)
        first, columns, values = self._stiffness.getValuesCSR()
        absolute = PETSc.Mat().createAIJ(
            self._stiffness.getSizes(),
            csr=(first, columns, np.abs(values)),
            comm=self._stiffness.comm,
        )
        reaction = np.abs(self.dofs.handed_over(self._times(absolute, own + opposite)))
        found = self.dofs.on_body(self._times(absolute, opposite), reaction)
        absolute.destroy()
        return found

    def _times(self, matrix: PETSc.Mat, jump: Array) -> Array:
        """A matrix of the slave's dofs times values at them; collective."""
        with self._jump as array:
            array[:] = jump
        matrix.mult(self._jump, self._force)
        return np.array(self._force.array_r)

    def destroy(self) -> None:
        """Free PETSc's objects."""
        self.dofs.destroy()
        for thing in (self._stiffness, self._jump, self._force):
            thing.destroy()


Pairs = tuple[Integers, Integers]


class ContactMatrix(AddedTangents):
    """The part of the tangent besides K, as a matrix, so that no copy of K is made.

    Attributes:
        matrix: The entries, in the layout of all unknowns; masters of contacts between bodies held.

    Args:
        problem: The problem.
        displacement: K of the displacements, before supports.
        diagonal: That of the constrained rows in K once these are cleared (force/length).
    """

    def __init__(self, problem: Problem, displacement: PETSc.Mat, diagonal: float) -> None:
        super().__init__(problem, displacement)
        self._diagonal = diagonal
        own = self._owned + (self.scalars if problem.comm.rank == 0 else 0)
        sizes = (own, PETSc.DETERMINE)
        self.matrix: PETSc.Mat = PETSc.Mat().createAIJ((sizes, sizes), comm=problem.comm)
        if self.scalars:
            self._place(displacement, self.matrix)
        constrained = problem.constrained[problem.constrained < self._owned]
        self._held = constrained
        self._constrained = self._rows(self.matrix, constrained)
        body = displacement.createVecRight()
        self._between: dict[SurfaceMatrix, PairMatrix] = {
            surface: PairMatrix(surface, pairing, body)
            for surface in self.surfaces
            if surface.contact.forces.terms
            and (pairing := surface.contact.kinematics.pairing) is not None
        }
        body.destroy()
        parts = [self._at_places(surface) for surface in self.surfaces]
        filled = sum(len(part[0]) for part in parts)
        parts += [self._with_scalar(number) for number in range(self.scalars)]
        rows, columns = (
            np.concatenate([np.zeros(0, dtype=np.int64), *part]).astype(PETSc.IntType)
            for part in (zip(*parts, strict=True) if parts else ((), ()))
        )
        self._room = np.zeros(len(rows) - filled)
        preallocate_places(self.matrix, rows, columns)
        self.matrix.assemble()
        keep = PETSc.Mat.Option.KEEP_NONZERO_PATTERN
        self.matrix.setOption(keep, True)

    def _at_places(self, surface: SurfaceMatrix) -> Pairs:
        """Pairs of dofs, one for each entry of a contact's tangent."""
        rows, columns = surface.places
        return self._matrix_rows(surface.dofs[rows]), self._matrix_rows(surface.dofs[columns])

    def _with_scalar(self, number: int) -> Pairs:
        """Pairs of a scalar with what it may be coupled with."""
        coupled = self._rows(self.matrix, self._border_dofs(number)).astype(np.int64)
        scalar = np.full(len(coupled), self._scalar_row(self.matrix, number))
        corner = np.zeros(0, dtype=np.int64)
        if self._problem.comm.rank == 0:
            corner = np.array([self._scalar_row(self.matrix, k) for k in range(self.scalars)])
        own = np.full(len(corner), self._scalar_row(self.matrix, number))
        return np.concatenate([coupled, scalar, own]), np.concatenate([scalar, coupled, corner])

    def pair_dofs(self, number: int) -> PairDofs:
        """The dofs of a contact between bodies, by its number."""
        return self._between[self.surfaces[number]].dofs

    def linearise(self) -> None:
        """Take the tangents that the contacts' terms have at present; collective."""
        entries = [surface.entries() for surface in self.surfaces]
        values = [found for _, _, found in entries]
        set_at_places(self.matrix, np.concatenate([*values, self._room]))
        for surface, motions, found in zip(self.surfaces, self._motions, entries, strict=True):
            if surface in self._between:
                self._between[surface].linearise(found[2])
            self._add_borders(self.matrix, surface, motions, found)
        self.add_prescribed(self.matrix)
        self.add_forces(self.matrix)
        self.add_stops(self.matrix)
        self.matrix.assemble()
        self.matrix.zeroRowsColumns(self._constrained, diag=0.0)
        if self._problem.body_scalars:
            self._hold_scalars()
        if any(unknown.prescribes is not None for unknown in self._unknowns):
            self.tie_prescribed(self.matrix)
            self._scale_ties()

    def _hold_scalars(self) -> None:
        """Unit rows and columns for scalars that are held; collective."""
        held = self.held_rows(self.matrix)
        self.matrix.zeroRowsColumns(held, diag=0.0)  # most rows have no diagonal here
        for row in held:
            self.matrix.setValue(row, row, self._diagonal)
        self.matrix.assemble()

    def _scale_ties(self) -> None:
        """The rows u − U R = 0 stand in K with its own diagonal."""
        scale = self.matrix.createVecLeft()
        scale.set(1.0)
        with scale as array:
            array[self._constrained - self.matrix.getOwnershipRange()[0]] = self._diagonal
        self.matrix.diagonalScale(scale, None)
        scale.destroy()

    def mult(self, vector: PETSc.Vec, result: PETSc.Vec) -> None:
        """K_c times a vector of all unknowns; collective."""
        self.matrix.mult(vector, result)
        displacement = self._free_displacement(vector)
        for pair in self._between.values():
            self._add_to_free(pair.forces(displacement), result)

    def magnitude(self, lengths: PETSc.Vec, result: PETSc.Vec) -> None:
        """|K_c| times a vector of no negative numbers; collective.

        Of P, which is not written out, the magnitude of what it makes of them.
        """
        first, columns, values = self.matrix.getValuesCSR()
        absolute = PETSc.Mat().createAIJ(
            self.matrix.getSizes(), csr=(first, columns, np.abs(values)), comm=self.matrix.comm
        )
        absolute.mult(lengths, result)
        absolute.destroy()
        displacement = self._free_displacement(lengths)
        for pair in self._between.values():
            self._add_to_free(pair.magnitudes(displacement), result)

    def _free_displacement(self, vector: PETSc.Vec) -> Array:
        """This rank's displacements of a vector, 0 where supports hold."""
        displacement = np.array(vector.array_r[: self._owned])
        displacement[self._held] = 0.0
        return displacement

    def _add_to_free(self, forces: Array, result: PETSc.Vec) -> None:
        """Add forces on this rank's displacements but where supports hold."""
        forces[self._held] = 0.0
        with result as array:
            array[: self._owned] += forces

    def destroy(self) -> None:
        """Free PETSc's objects."""
        for thing in (self.matrix, *self._between.values()):
            thing.destroy()
