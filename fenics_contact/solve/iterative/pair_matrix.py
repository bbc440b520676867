"""What the master adds to K_c of a slave, applied: Jᵀ K_c J − K_c with the jump J u = u − P u'.

Every rank has the rows of its own nodes of both surfaces.
"""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.contact.mortar.pairing import Pairing
from fenics_contact.contact.surface.space import SurfaceSpace
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix
from fenics_contact.solve.systems.petsc_library import preallocate_places, set_at_places


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
        """The same with magnitudes of K_c, and of what P makes of its arguments; collective."""
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
