"""Have the condensed tangent solved as on large contacts, however small they are."""

from mpi4py import MPI

from fenics_contact.solve.condensed import tangent
from fenics_contact.solve.condensed.split_solver import SplitSolver
from fenics_contact.solve.condensed.tangent import UnknownsTangent

COMM = MPI.COMM_WORLD


class Split:
    """Counts what the solver of stiff and soft parts is asked for on rank 0.

    Attributes:
        factorised: How often it made its factors.
        solved: Of its solves, whether each found an answer.
    """

    def __init__(self, monkeypatch):
        self.factorised = 0
        self.solved = []
        plain_factors, plain_solve = SplitSolver.factorise, SplitSolver.solve

        def factorise(solver):
            self.factorised += 1
            return plain_factors(solver)

        def solve(solver, right, *left):
            found = plain_solve(solver, right, *left)
            self.solved.append(found is not None)
            return found

        monkeypatch.setattr(tangent, "_FEW", -1)
        monkeypatch.setattr(UnknownsTangent, "_is_short", False)  # also where S⁻¹ is known
        monkeypatch.setattr(UnknownsTangent, "_is_shorter", lambda tangent, soft: True)
        monkeypatch.setattr(SplitSolver, "factorise", factorise)
        monkeypatch.setattr(SplitSolver, "solve", solve)

    def require_used(self):
        """It was, and never left a solve to the other way; collective."""
        assert COMM.bcast(self.factorised > 0)
        assert COMM.bcast(all(self.solved))
