"""Derivatives of an exact answer: the transposed solve of the linearised laws at the points."""

from __future__ import annotations

from dataclasses import dataclass

from mpi4py import MPI

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.parallel import from_root
from fenics_contact.solve.at_points.contact_points import ContactPoints
from fenics_contact.solve.at_points.point_operator import PointOperator
from fenics_contact.solve.exact.answer import ExactAnswer
from fenics_contact.solve.exact.derivatives import ExactGradient, Linearisation


@dataclass(frozen=True, eq=False)
class PointGradient:
    """Gradient of a quantity in what the points of a contact are given.

    Attributes:
        openings: In gaps and slips, (points, rows of a point).
        bound: In a force added to the bound of friction, (points,).
        elastic_slip: In ε, (points,).
    """

    openings: Array
    bound: Array
    elastic_slip: Array


class PointAdjoint:
    """The laws of all points, linearised at an answer; collective.

    Attributes:
        forces: At the points of all contacts, on every rank, (rows,) (force).

    Args:
        operator: How forces move points.
        answer: On rank 0; None on others, or where none was found.
        forces: As of the attributes.
        comm: Of the ranks.

    Raises:
        NotConvergedError: There is no answer, or the linearised laws are singular.
    """

    def __init__(
        self, operator: PointOperator, answer: ExactAnswer | None, forces: Array, comm: MPI.Comm
    ) -> None:
        self._operator, self._comm, self.forces = operator, comm, forces
        self._linear: Linearisation | None = None
        ends = comm.rank == 0 and answer is None
        if answer is not None:
            try:
                self._linear = Linearisation(answer)
            except ValueError:
                ends = True
        if from_root(comm, ends):
            raise NotConvergedError(
                "derivatives: the answer is at a limit, where it does not follow what is given"
            )

    @property
    def points(self) -> list[ContactPoints]:
        """Points of each contact that takes part, in scene order."""
        return list(self._operator.points)

    def solve(
        self, of_unknowns: Array, of_forces: Array
    ) -> tuple[Array | None, list[PointGradient]]:
        """Multipliers of a quantity, and its gradient in what the points are given; collective.

        Args:
            of_unknowns: Its gradient in the unknowns while forces at the points stay, on rank 0.
            of_forces: In these forces while the unknowns stay, (rows,).

        Returns:
            Λ at the unknowns, on rank 0, and a gradient for each contact that takes part, on every
            rank.
        """
        found, own = None, None
        if self._linear is not None:
            every = self._operator.of_forces(of_unknowns)
            every[: self._operator.rows] += of_forces
            own = self._linear.gradient(every)
            found = self._operator.multipliers(of_unknowns, own.free)
        gradient = from_root(self._comm, own)
        assert gradient is not None
        return found, self._by_contact(gradient)

    def _by_contact(self, gradient: ExactGradient) -> list[PointGradient]:
        parts, first = [], 0
        for one in self.points:
            last = first + one.count
            parts.append(
                PointGradient(
                    openings=gradient.free[first * one.size : last * one.size].reshape(
                        -1, one.size
                    ),
                    bound=gradient.bound[first:last],
                    elastic_slip=gradient.elastic_slip[first:last],
                )
            )
            first = last
        return parts
