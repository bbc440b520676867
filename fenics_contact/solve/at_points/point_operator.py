"""How far forces at contact points move them, everything else being in balance: v = W r + q.

v are gaps and slips at the points and r the forces across and along (``contact_points``). Where
forces drive an obstacle, or nothing but contact holds a body, springs hold what would be free, and
the foot of each is one more unknown: its row is the place that the spring holds, less the foot.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_matrix, vstack

from fenics_contact.common.arrays import Array
from fenics_contact.solve.at_points.contact_points import ContactPoints
from fenics_contact.solve.at_points.sprung_inverse import SprungInverse
from fenics_contact.solve.condensed.condensed_system import CondensedSystem


class PointOperator:
    """W, and what forces at the points do to the unknowns; the making of it is collective.

    Attributes:
        points: Those of each contact that takes part.
        rows: Number of rows of all points; those of feet come after them.
        compliance: W with rows and columns of the feet, on rank 0; else None.

    Args:
        system: The condensed problem.
        points: Of all contacts that exert forces, in scene order.
    """

    def __init__(self, system: CondensedSystem, points: Sequence[ContactPoints]) -> None:
        self.points, self._system = points, system
        self.rows: int = sum(one.count * one.size for one in points)
        rows = [one.jump_rows() for one in points]
        self.compliance: Array | None = None
        tangent = system.dense_tangent
        if tangent is None:
            return
        inner, self._border = tangent.inner, tangent.border
        self._inverse = SprungInverse(inner.compliance, tangent.border, inner.size)
        jumps = [system.jump_of(one.contact) for one in points]
        self._moves = self._stacked(rows, [jump.motions for jump in jumps])
        works = self._stacked(rows, [jump.works for jump in jumps])
        feet, springs = self._inverse.feet, self._inverse.springs
        moved = np.empty((self._moves.shape[1], self.rows + len(feet)))
        moved[:, : self.rows] = (works @ self._inverse.matrix.T).T
        moved[:, self.rows :] = self._inverse.matrix[:, feet] * springs
        self._moved = moved
        self.compliance = self._at_rows(moved)
        diagonal = np.arange(self.rows, len(self.compliance))
        self.compliance[diagonal, diagonal] -= 1.0

    @property
    def size(self) -> int:
        """Number of rows with those of feet, on rank 0; 0 on others."""
        return 0 if self.compliance is None else len(self.compliance)

    def _stacked(self, rows: Sequence[csr_matrix], jumps: Sequence[csr_matrix]) -> csr_matrix:
        """Rows of all points over all that the inverse is of.

        Args:
            rows: Of each contact, over the dofs of its surface.
            jumps: Of each contact at these dofs, over the unknowns.
        """
        products = [row @ jump for row, jump in zip(rows, jumps, strict=True)]
        found = vstack(products).tocsr()
        found.resize((self.rows, len(self._inverse.matrix)))
        return found

    def _at_rows(self, changes: Array) -> Array:
        """Gaps, slips and places of what springs hold, by changes of the unknowns."""
        return np.concatenate([self._moves @ changes, changes[self._inverse.feet]])

    def openings(self) -> Array:
        """Gaps and slips in balance with the forces that contacts have now; collective.

        Without forces of contacts these are q.

        Returns:
            On rank 0 (rows + feet,), feet relative to where they are in the present state; empty
            on others.
        """
        system = self._system
        system.balance(system.state, system.residual)
        present = [one.openings().ravel() for one in self.points]
        if self.compliance is None:
            return np.zeros(0)
        self._fallen = -self._inverse.solve(self._spread(np.array(system.residual.array_r)))
        found = self._at_rows(self._fallen)
        found[: self.rows] += np.concatenate(present)
        return found

    def move(self, forces: Array) -> None:
        """Take the unknowns to where they are under further forces at the points; collective.

        The state is still that of ``openings``.

        Args:
            forces: On rank 0, beside those that acted then, with the feet, (rows + feet,) (force,
                length).
        """
        system = self._system
        if self.compliance is not None:
            change = self._fallen + self._moved @ forces
            with system.state as array:
                array[:] += self._gathered(change)
        system.take(system.state)

    def of_forces(self, of_unknowns: Array) -> Array:
        """Gradient of a quantity in forces at the points, by that in the system's unknowns.

        Args:
            of_unknowns: On rank 0, with the body's scalars, (unknowns,).

        Returns:
            With the feet, (rows + feet,).
        """
        return np.asarray(self._spread(of_unknowns) @ self._moved)

    def multipliers(self, of_unknowns: Array, of_openings: Array) -> Array:
        """Λ: gradient of a quantity in forces on the system's unknowns; on rank 0.

        Of scalars that are held, over the entries of their rows.

        Args:
            of_unknowns: Its gradient in the unknowns while forces at points stay, (unknowns,).
            of_openings: In q, with the feet, (rows + feet,).
        """
        inverse, size = self._inverse, self._system.width
        right = self._spread(of_unknowns) + of_openings[: self.rows] @ self._moves
        right[inverse.feet] += of_openings[self.rows :]
        found = self._gathered(right @ inverse.matrix)
        found[size:][self._border.held] = self._border.multipliers_of_held(
            of_unknowns[size:], found
        )
        return found

    def _spread(self, values: Array) -> Array:
        """Forces on the system's unknowns, over all that the inverse is of."""
        size = len(values) - len(self._inverse.free)
        found = np.zeros(len(self._inverse.matrix))
        found[:size] = values[:size]
        found[self._inverse.inner :] = values[size:][self._inverse.free]
        return found

    def _gathered(self, changes: Array) -> Array:
        """Changes of the system's unknowns; what is held does not change."""
        inverse = self._inverse
        size = self._system.width
        found = np.zeros(size + len(inverse.free))
        found[:size] = changes[:size]
        found[size:][inverse.free] = changes[inverse.inner :]
        return found
