"""Which solver a problem gets, and whether the machine has the memory for it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fenics_contact.common.errors import InputError, MachineError
from fenics_contact.common.failures import LESS_MEMORY
from fenics_contact.common.memory import free_memory_for, memory_limit
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import is_part_free
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.iterative.carried_slaves import cannot_be_carried
from fenics_contact.solve.iterative.iterative_system import IterativeSystem
from fenics_contact.solve.memory import Name, contact_unknowns, memory_estimate, unknowns
from fenics_contact.solve.systems.full_system import FullSystem
from fenics_contact.solve.systems.system import System

# Unknowns from which multigrid is faster in 3D, by degree (measured on one rank).
_ITERATIVE_FROM = {1: 50_000, 2: 100_000}
# Dofs of contacts from which it is, with obstacles and between bodies, both surfaces counted: the
# Schur complement of ``condensed`` grows with them (likewise).
_LARGE_CONTACT, _LARGE_PAIR = 2_000, 2_500


@dataclass(frozen=True)
class SolverChoice:
    """A solver, and why.

    Attributes:
        name: ``condensed``, ``full`` or ``iterative``.
        reason: In words.
        memory: Estimate for all ranks together (bytes).
    """

    name: Name
    reason: str
    memory: float


def choose_solver(problem: Problem, is_kept: bool = False) -> SolverChoice:
    """The scene's solver, or the one that suits its sizes; collective.

    Args:
        problem: The problem.
        is_kept: Whether the body is to serve many problems, so that it is condensed.

    Raises:
        InputError: The solver that the scene asks for is not for its model.
        MachineError: The problem will not fit into the machine's memory.
    """
    wanted = problem.scene.solver.solver
    free = free_memory_for(problem.comm)
    if wanted == "auto":
        choice = _of_kept_body(problem) if is_kept else _automatic(problem, free)
    else:
        if wanted == "iterative" and not _suits_multigrid(problem):
            raise InputError(
                "solver.solver = 'iterative' is for 3D models, and not for nearly incompressible "
                "materials; use 'condensed' or 'full'"
            )
        if wanted == "iterative" and (why := cannot_be_carried(problem)):
            raise InputError(
                f"solver.solver = 'iterative' is not for this model: {why}; choose contact.slave "
                "otherwise, or use 'condensed'"
            )
        choice = SolverChoice(wanted, "as the scene says", memory_estimate(problem, wanted))
    if choice.memory > free:
        raise MachineError(
            f"the solver '{choice.name}' needs about {choice.memory / 1e9:.2g} GB of memory for "
            f"{unknowns(problem):,} unknowns, and {free / 1e9:.2g} GB are free "
            f"{memory_limit(problem.comm)}; {_that_would_do(problem, choice, free)}{LESS_MEMORY}"
        )
    return choice


def _that_would_do(problem: Problem, refused: SolverChoice, free: float) -> str:
    """Advice to take another solver, if one fits that is for the model; collective."""
    names: list[Name] = []
    if not problem.inertia.moves and _suits_multigrid(problem) and not cannot_be_carried(problem):
        names.append("iterative")
    names += ["condensed"] if problem.inertia.moves else ["condensed", "full"]
    for name in names:
        memory = memory_estimate(problem, name)
        if name != refused.name and memory <= free:
            needs = f"about {memory / 1e9:.2g} GB"
            return f"solver.solver = '{name}' needs {needs} and would do; or "
    return ""


def _of_kept_body(problem: Problem) -> SolverChoice:
    """What costs least once it is there."""
    memory = memory_estimate(problem, "condensed")
    return SolverChoice("condensed", "one factorisation of the bulk for all answers", memory)


def _automatic(problem: Problem, free: float) -> SolverChoice:
    """What is expected to be fastest of what fits; collective."""

    def choice(name: Name, reason: str) -> SolverChoice:
        return SolverChoice(name, reason, memory_estimate(problem, name))

    if problem.inertia.moves:
        return choice("condensed", "one factorisation of the bulk for all steps of the motion")
    if not any(contact.forces.terms for contact in problem.contacts):
        return choice("full", "nothing to iterate on")
    condensed = choice("condensed", "one factorisation of the bulk")
    if not _suits_multigrid(problem):
        return condensed
    if cannot_be_carried(problem):
        return condensed
    if condensed.memory > free:
        return choice("iterative", "a factorisation would not fit into memory")
    # Multigrid takes ever more cycles for bodies that contacts alone hold.
    if is_part_free(problem).any():
        return choice("condensed", "one factorisation of bodies that contacts alone hold")
    # Each further step costs the iterative solver about half of the first, the other nothing.
    steps = 0.5 + 0.5 * len(problem.scene.load_steps.all_times)
    large = _LARGE_PAIR if problem.between_bodies else _LARGE_CONTACT
    if contact_unknowns(problem) > steps * large:
        return choice("iterative", "multigrid is faster than condensing onto so large a contact")
    if problem.between_bodies:
        return condensed
    if unknowns(problem) > steps * _ITERATIVE_FROM[problem.spaces.degree]:
        return choice("iterative", "multigrid is faster than a factorisation of this size")
    return condensed


def _suits_multigrid(problem: Problem) -> bool:
    """Whether there is multigrid for K: none for a mean stress, none that is sure on the axis."""
    return problem.spaces.components == 3 and problem.elastic.mixed is None


# Gives a body that is kept, condensed for a problem, None where it cannot serve; collective.
Condense = Callable[[Problem, Timings], CondensedBody | None]


def create_system(
    problem: Problem, choice: SolverChoice, timings: Timings, condense: Condense | None = None
) -> System:
    """What Newton's method is to solve; collective.

    Args:
        problem: The problem.
        choice: The solver.
        timings: Seconds so far.
        condense: Gives the body condensed, if one is kept for several problems.
    """
    if choice.name == "condensed":
        return CondensedSystem(problem, timings, condense and condense(problem, timings))
    return {"full": FullSystem, "iterative": IterativeSystem}[choice.name](problem, timings)
