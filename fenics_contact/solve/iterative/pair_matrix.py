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


class PairMatrix:
    """The part of a contact between bodies that the matrix of the slave lacks.

    Args:
        surface: K_c of the slave.
        pairing: What faces what.
        body: A vector of the displacements' layout.
    """

    def __init__(self, surface: SurfaceMatrix, pairing: Pairing, body: PETSc.Vec) -> None:
        self._pairing = pairing
        slave = surface.contact.trace.surface
        self._components = slave.components
        owned = slave.owned_nodes * slave.components
        self._stiffness: PETSc.Mat = PETSc.Mat().createAIJ(
            ((owned, PETSc.DETERMINE), (owned, PETSc.DETERMINE)), comm=slave.comm
        )
        assembled = surface.assembled
        none = np.zeros(0, dtype=np.int64)
        places = (none, none) if assembled is None else (assembled.rows, assembled.columns)
        preallocate_places(self._stiffness, *places)
        self._body = body.duplicate()
        self._slave, self._of_slave = self._part(slave)
        self._master, self._of_master = self._part(pairing.master)
        self._jump, self._force = self._slave.duplicate(), self._slave.duplicate()

    def _part(self, surface: SurfaceSpace) -> tuple[PETSc.Vec, PETSc.Scatter]:
        """A vector of a surface's dofs, and what takes the body's there."""
        dofs: Integers = surface.own_dofs
        vector: PETSc.Vec = PETSc.Vec().createMPI((len(dofs), PETSc.DETERMINE), comm=surface.comm)
        places = PETSc.IS().createGeneral(dofs.astype(PETSc.IntType), comm=surface.comm)
        scatter = PETSc.Scatter().create(self._body, places, vector, None)
        places.destroy()
        return vector, scatter

    def linearise(self, values: Array) -> None:
        """Take K_c, by the values of its entries on this rank; collective."""
        set_at_places(self._stiffness, values)

    def forces(self, displacement: Array) -> Array:
        """On the displacements that this rank owns in the body, (owned,); collective.

        Args:
            displacement: Likewise (length).
        """
        opposite = self._opposite(displacement)
        with self._jump as jump:
            jump[:] = self._slave.array_r - opposite
        self._stiffness.mult(self._jump, self._force)
        reaction = -self._handed_over(self._force.array_r)
        with self._jump as jump:
            jump[:] = -opposite
        self._stiffness.mult(self._jump, self._force)
        return self._on_body(reaction)

    def magnitudes(self, displacement: Array) -> Array:
        """The same with magnitudes of K_c, and of what P makes of its arguments; collective."""
        opposite = np.abs(self._opposite(displacement))
        first, columns, values = self._stiffness.getValuesCSR()
        absolute = PETSc.Mat().createAIJ(
            self._stiffness.getSizes(),
            csr=(first, columns, np.abs(values)),
            comm=self._stiffness.comm,
        )
        with self._jump as jump:
            jump[:] = self._slave.array_r + opposite
        absolute.mult(self._jump, self._force)
        reaction = np.abs(self._handed_over(self._force.array_r))
        with self._jump as jump:
            jump[:] = opposite
        absolute.mult(self._jump, self._force)
        absolute.destroy()
        return self._on_body(reaction)

    def _opposite(self, displacement: Array) -> Array:
        """P u' at this rank's own dofs of the slave, whose displacements are taken as well."""
        with self._body as array:
            array[:] = displacement
        for vector, scatter in ((self._slave, self._of_slave), (self._master, self._of_master)):
            scatter.scatter(self._body, vector)
        moved = self._master.array_r.reshape(-1, self._components)
        return self._pairing.projection.apply(moved).reshape(-1)

    def _handed_over(self, forces: Array) -> Array:
        """Pᵀ f at this rank's own dofs of the master."""
        nodal = forces.reshape(-1, self._components)
        return self._pairing.projection.transposed(nodal).reshape(-1)

    def _on_body(self, reaction: Array) -> Array:
        """The last forces on the slave and those on the master, as the body has them."""
        with self._master as array:
            array[:] = reaction
        self._body.set(0.0)
        add, reverse = PETSc.InsertMode.ADD_VALUES, PETSc.ScatterMode.REVERSE
        self._of_slave.scatter(self._force, self._body, add, reverse)
        self._of_master.scatter(self._master, self._body, add, reverse)
        return np.array(self._body.array_r)

    def destroy(self) -> None:
        """Free PETSc's objects."""
        for thing in (
            self._stiffness,
            self._body,
            self._slave,
            self._of_slave,
            self._master,
            self._of_master,
            self._jump,
            self._force,
        ):
            thing.destroy()
