"""The jump of one contact over the unknowns of the condensed problem."""

from __future__ import annotations

from dataclasses import dataclass

from scipy.sparse import csr_matrix

from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix


@dataclass(frozen=True, eq=False)
class ContactJump:
    """The jump w = B (y, z) + c of one contact; rows are dofs of its surface.

    Columns are the unknowns y, then the derived jumps z.

    Attributes:
        surface: Tangent in the jump.
        relative: Displacement relative to a body opposite: B without an obstacle's motion.
        motion: B: contact variables, an obstacle's motion, the far field of resultants.
        work: L: rows of the balance that its forces enter, Lᵀ: as B, without the far field,
            and its direction for a resultant.
    """

    surface: SurfaceMatrix
    relative: csr_matrix
    motion: csr_matrix
    work: csr_matrix
