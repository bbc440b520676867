"""Whether the answer of a run is the only one: up to which coefficient, and others that are found.

Up to which coefficient Coulomb's friction has one answer, estimated. Points that touch and slip
one way satisfy p ≥ 0, gap ≥ 0, p · gap = 0, gap = G_nn p ± G_nt M p + c. The compliance G of the
body (or of both) at the contact says how far forces across and along it move its points across it,
and M is the friction coefficient; of nonlocal friction it is M Wᵀ, as bounds follow the pressures'
averages W. If pᵀ(G_nn ± G_nt M) p > 0 for all p ≠ 0, such a problem has exactly one answer,
whatever the loads (R. W. Cottle, J.-S. Pang, R. E. Stone, The Linear Complementarity Problem, SIAM
2009, Theorem 3.1.6). Beyond, there may be several: P. Hild, C. R. Acad. Sci. Paris, Ser. I 337
(2003) 685-688. It is an estimate, as points may also stick, and slip in several directions at
once.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import LinAlgError, cholesky, solve_triangular
from scipy.sparse import csr_matrix, diags
from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import from_root, gather_rows, largest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.evaluate.contact_quantities import contact_quantities
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.evaluate.quantities import global_quantities
from fenics_contact.problem.problem import Problem
from fenics_contact.results.records.contacts import BranchContact
from fenics_contact.results.records.steps import BranchRecord
from fenics_contact.solve.at_points.exact_step import ExactSolver
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.branches import exact_answers, other_solutions
from fenics_contact.trust.heat_answers import other_temperatures
from fenics_contact.trust.run_checks import run_checks

# Points at the most; of more, those that touch.
_MOST = 1500
# Directions along a surface in 3D, over half a turn: opposite ones give the same.
_DIRECTIONS = 4
# Share of the coefficient below which it is round-off.
_NONE = 1e-9
# Of an eigenvalue that is compared with 1.
_TOLERANCE = 1e-3


def uniqueness_limit(system: CondensedSystem, number: int, every: bool = False) -> float | None:
    """Largest friction coefficient of a contact that leaves one answer, estimated; collective.

    The others are taken to be open. The coefficient is the derivative of the bound in the pressure,
    μ of Coulomb's law. Where the coefficient varies, its largest value counts, the
    others being in proportion.

    Points count whose gap is no wider than the largest displacement across the contact.

    Args:
        system: Its state says what touches.
        number: Of a contact with Coulomb's friction, in scene order.
        every: Let all points count, whatever touches: what leaves these one answer leaves it to
            any of them.

    Returns:
        The coefficient; None where none takes uniqueness away (forces along the contact move
        nothing across it), where only contact holds a body, or too many points touch.
    """
    contact = system.problem.contacts[number]
    rows = _points(contact, every)
    if len(rows) == 0:
        return None
    size = contact.spaces.components
    places, coefficient = rows[:, 0].astype(np.int64), rows[:, 1]
    normals = rows[:, 2 : 2 + size]
    across = _along(places, normals, system.surface_size(number))
    ways = [_along(places, way, system.surface_size(number)) for way in _tangents(normals)]
    found = system.compliances(number, across, ways)
    neighbours = contact.friction.neighbours
    friction = diags(coefficient)  # M, of forces at points
    if neighbours is not None:  # a pressure's share in the bounds around it, as forces
        friction = friction @ neighbours.matrix[places][:, places].T
    share = None if found is None else _largest_share(*found, friction)
    share = from_root(system.comm, share)
    return float(coefficient.max() / share) if share is not None and share > _NONE else None


def _points(contact: ContactSurface, every: bool) -> Array:
    """Place among the surface's nodes, coefficient and normal of the points to look at."""
    trace, comm = contact.trace, contact.spaces.comm
    count = len(contact.nodes)
    friction = contact.friction
    steepest = friction.largest_coefficient if every else friction.bound_slope(contact.pressure())
    coefficient = steepest[:count]
    counted = contact.owned_nodes & contact.supports.free_across & (coefficient > 0)
    # Points that displacements as large as those found may close.
    kinematics = contact.kinematics
    moved = largest(comm, np.abs(kinematics.normal(kinematics.jump_at_points())))
    depth = np.inf if every else moved
    counted &= kinematics.gap[:count] <= depth
    places = trace.surface.numbers[trace.numbers]
    rows = np.column_stack([places, coefficient, trace.normals[:count]])
    found = gather_rows(comm, rows[counted])
    if len(found) > _MOST and not every:
        found = gather_rows(comm, rows[counted & (contact.pressure()[:count] > 0)])
    if len(found) > _MOST:
        return found[:0]
    return found[np.argsort(found[:, 0])]


def _along(places: Integers, directions: Array, nodes: int) -> csr_matrix:
    """Takes the parts along directions (points, components) out of values at all nodes."""
    count, size = directions.shape
    rows = np.repeat(np.arange(count), size)
    columns = (places[:, None] * size + np.arange(size)).ravel()
    return csr_matrix((directions.ravel(), (rows, columns)), shape=(count, nodes * size))


def _tangents(normals: Array) -> list[Array]:
    """Unit tangents of slip in one direction, for several; (points, components) each."""
    if normals.shape[1] == 2:
        return [np.stack([-normals[:, 1], normals[:, 0]], axis=1)]
    # The plane that the surface is nearest to; on a closed surface, any.
    _, _, axes = np.linalg.svd(np.vstack([normals.mean(axis=0), np.zeros((2, 3))]))
    angles = np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    found = []
    for way in np.outer(np.cos(angles), axes[1]) + np.outer(np.sin(angles), axes[2]):
        along = way - (normals @ way)[:, None] * normals
        lengths = np.linalg.norm(along, axis=1)[:, None]
        found.append(np.where(lengths > 0, along / np.where(lengths > 0, lengths, 1.0), 0.0))
    return found


def _largest_share(across: Array, couplings: list[Array], friction: csr_matrix) -> float | None:
    """Largest |pᵀ G_nt M p| over pᵀ G_nn p."""
    try:
        root = cholesky(across, lower=True)
    except LinAlgError:
        return None
    worst = 0.0
    for coupling in couplings:
        slipping = np.asarray(coupling @ friction)
        symmetric = 0.5 * (slipping + slipping.T)

        def scaled(vector: Array, symmetric: Array = symmetric) -> Array:
            inner = solve_triangular(root, vector.ravel(), lower=True, trans="T")
            return np.asarray(solve_triangular(root, symmetric @ inner, lower=True))

        worst = max(worst, _largest_eigenvalue(scaled, len(across)))
    return worst


def _largest_eigenvalue(product: Callable[[Array], Array], size: int) -> float:
    """The largest magnitude of a symmetric operator's eigenvalues."""
    if size >= 3:  # of fewer, Lanczos' method finds none
        operator = LinearOperator((size, size), matvec=product, dtype=np.float64)
        start = np.cos(np.arange(size))  # the same on every run
        # Nothing comes of it where slip moves nothing across, and of clusters it may not converge.
        with suppress(ArpackError):
            found = eigsh(operator, 1, tol=_TOLERANCE, v0=start, return_eigenvectors=False)
            return float(np.abs(found).max())
    columns = [product(unit) for unit in np.eye(size)]
    return float(np.abs(np.linalg.eigvalsh(np.array(columns).T)).max())


@dataclass(frozen=True)
class OtherAnswers:
    """Answers other than the one that a run reports, as far as known.

    Attributes:
        limits: Of each contact with Coulomb's friction, by its name: the coefficient up to which
            the answer is the only one by an estimate, and the coefficient that it has.
        branches: Answers, that of the run first, as in ``result.json``; empty if not asked for.
        without_answer: Number of starts from which none was found.
        way: How answers of contacts that are solved exactly were looked for; empty of others.
        complete: Whether there are surely no others than these.
    """

    limits: dict[str, tuple[float, float]] = field(default_factory=dict)
    branches: list[BranchRecord] = field(default_factory=list)
    without_answer: int = 0
    way: str = ""
    complete: bool = False

    def limit(self, contact: str) -> float | None:
        """``uniqueness_limit`` of a contact for ``result.json``, None where there is none."""
        return self.limits[contact][0] if contact in self.limits else None

    def words(self) -> str:
        """Sentences for the verdict, or nothing; an answer that fails a check counts for none."""
        if self.way:
            return self._exact_words()
        others = [branch.start for branch in self.branches[1:] if branch.passed]
        if others:
            starts = " and ".join(f"'{start}'" for start in others)
            return (
                f" It is not the only answer: {1 + len(others)} were found, the others from the "
                f"starts {starts}; see branches in result.json."
            )
        beyond = [
            f"at '{name}' ({has:.3g} > {limit:.3g})"
            for name, (limit, has) in self.limits.items()
            if has > limit
        ]
        if not beyond:
            return ""
        looked = "solver.branches looks for them"
        if self.branches:
            looked = "none was found from other starts"
        if self.without_answer:
            looked += f", {self.without_answer} of which did not converge"
        return (
            " The friction coefficient is larger than what leaves a single answer, by an estimate, "
            f"{' and '.join(beyond)}: there may be others; {looked}."
        )

    def _exact_words(self) -> str:
        count = len(self.branches)
        if count > 1:
            return (
                f" It is not the only answer: {count} were found, {self.way}; see branches in "
                "result.json."
            )
        if self.complete:
            return f" It is the only answer, {self.way}."
        return f" No other answer was found, {self.way}."


def search_other_solutions(load_steps: LoadSteps) -> OtherAnswers:
    """Estimate limits of uniqueness, and look for other answers if the scene asks; collective."""
    problem, system = load_steps.problem, load_steps.newton.system
    if problem.inertia.moves:  # masses decide where bodies go
        return OtherAnswers()
    limits: dict[str, tuple[float, float]] = {}
    for number, contact in enumerate(problem.contacts):
        if contact.is_coulomb and isinstance(system, CondensedSystem):
            limit = uniqueness_limit(system, number)
            coefficient = contact.friction.bound_slope(contact.pressure())
            if limit is not None:
                limits[contact.label] = limit, largest(problem.comm, coefficient)
    branches, without_answer, solver = [], 0, problem.scene.solver
    exact = load_steps.newton.exact
    if exact is not None:
        asked = solver.branches or solver.all_answers
        return _of_points(load_steps, exact, limits) if asked else OtherAnswers(limits)
    if solver.branches and problem.coulomb and load_steps.last is not None:
        branches.append(_branch(problem, "as solved", load_steps.last.solution))
        for start, found in other_solutions(load_steps):
            if found is None:
                without_answer += 1
            else:
                branches.append(_branch(problem, start, found))
    return OtherAnswers(limits, [*branches, *_of_temperatures(load_steps)], without_answer)


def _of_points(
    load_steps: LoadSteps, exact: ExactSolver, limits: dict[str, tuple[float, float]]
) -> OtherAnswers:
    """All answers of contacts that are solved exactly, the known one first; collective."""
    problem, last = load_steps.problem, load_steps.last
    assert last is not None
    branches = [_branch(problem, "as solved", last.solution)]
    found = exact_answers(load_steps, exact)
    branches += [_branch(problem, name, solution) for name, solution in found.others]
    return OtherAnswers(limits, branches, way=found.way, complete=found.complete)


def _of_temperatures(load_steps: LoadSteps) -> list[BranchRecord]:
    """All answers with other temperatures, the known one first; none if it is the only one."""
    problem, last = load_steps.problem, load_steps.last
    conduction = problem.conduction
    is_single = not problem.scene.load_steps.several
    if conduction is None or not conduction.may_have_several_answers or not is_single or not last:
        return []
    found = [
        _branch(problem, start, solution)
        for start, solution in other_temperatures(load_steps)
        if solution is not None
    ]
    return [_branch(problem, "as solved", last.solution), *found] if found else []


def _branch(problem: Problem, start: str, solution: Solution) -> BranchRecord:
    forces = BulkForces(problem, solution)
    by_contact = [
        contact_quantities(problem, solution, number) for number in range(len(problem.contacts))
    ]
    checks = run_checks(forces)
    return BranchRecord(
        start=start,
        newton_iterations=solution.newton_iterations,
        passed=all(check.passed for check in checks.values()),
        quantities=global_quantities(forces, by_contact),
        contacts=[
            BranchContact(name=contact.label, quantities=found)
            for contact, found in zip(problem.contacts, by_contact, strict=True)
        ],
    )
