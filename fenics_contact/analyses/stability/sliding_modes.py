"""Complex modes about a state in which all contacts slide, and where they begin to flutter.

The modes are those of s² M + s C + K with a K that is not symmetric. With Rayleigh's damping
C = α M + β K they are those of K φ = κ M φ, and s² + (α + β κ) s + κ = 0. A κ that is not real
makes a pair of modes of one frequency, of which one grows: flutter. A κ < 0 makes one that grows
without swinging: divergence.

Friction in steady sliding is μ p against the direction of sliding, whatever small displacements
come on top: these change the pressure p, and neither the direction nor the contact area. So the
tangent of a contact is (n + μ d) ⊗ ∂p/∂u, which is not symmetric, and that of what is held across
the contact is that of trial displacements u_n = 0 with test displacements w_n = μ w_t.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, eigs

from fenics_contact.body.mass import Mass
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError, NotConvergedError
from fenics_contact.common.parallel import largest, of_every_rank, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import SLIP
from fenics_contact.problem.massless import ContactMasses
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.free_modes import LinearisedBody, ServedOperators, Vectors

Complex = NDArray[np.complex128]
Times = Callable[[Array], Array]

# Of eigenvalues: beyond what meshes are worth, and within what round-off allows.
_ACCURATE = 1e-10
# Of 1/κ over the largest one: of nodes that have no mass.
_MASSLESS = 1e-13
# Unknowns up to which all modes are found.
_FEW = 40
# Of a growth rate over ω: less is round-off, as of two equal frequencies.
GROWS = 1e-6


def lowest_squares(
    size: int, number: int, times_mass: Times, solve: Times
) -> tuple[Complex, Complex]:
    """κ and φ of K φ = κ M φ for the smallest |κ|.

    Args:
        size: Number of unknowns.
        number: How many; one more where that would cut a pair.
        times_mass: M u.
        solve: K⁻¹ f.

    Returns:
        κ in the order of |κ|, and the φ as columns; fewer where there are fewer.
    """

    def times(vector: Array) -> Array:
        return solve(times_mass(vector))

    if size <= max(_FEW, 2 * number + 4):
        flexibilities, shapes = np.linalg.eig(np.array([times(unit) for unit in np.eye(size)]).T)
    else:
        count = number + 1
        flexibilities, shapes = eigs(
            LinearOperator((size, size), matvec=times, dtype=np.float64),
            k=count,
            which="LM",
            v0=times(np.random.default_rng(0).normal(size=size)),
            ncv=min(size, max(2 * count + 2, 24)),
            tol=_ACCURATE,
        )
    sizes = np.abs(flexibilities)
    order = np.argsort(-sizes, kind="stable")
    order = order[sizes[order] > _MASSLESS * sizes.max(initial=0.0)]
    squares = 1.0 / flexibilities[order].astype(np.complex128)
    count = min(number, len(squares))
    if count < len(squares) and _is_pair(squares[count - 1], squares[count]):
        count += 1
    return squares[:count], shapes[:, order[:count]].astype(np.complex128)


def _is_pair(one: complex, other: complex) -> bool:
    return bool(one.imag != 0 and abs(one - other.conjugate()) <= 1e-8 * abs(one))


def exponents(squares: Complex, of_mass: float = 0.0, of_stiffness: float = 0.0) -> Complex:
    """Exponents s of each κ: that of the two which swings forward, or else which grows faster.

    Args:
        squares: κ.
        of_mass: α (1/time).
        of_stiffness: β (time).

    Returns:
        Growth rates as real parts, angular frequencies as imaginary ones (1/time).
    """
    half = 0.5 * (of_mass + of_stiffness * squares)
    root = np.sqrt(half**2 - squares)
    one, other = -half + root, -half - root
    swings = np.maximum(np.abs(one.imag), np.abs(other.imag)) > 0
    takes_one = np.where(swings, one.imag >= other.imag, one.real >= other.real)
    return np.where(takes_one, one, other)


def grows(found: Complex) -> bool:
    """Whether some mode does, by more than round-off.

    Args:
        found: As of ``exponents``.
    """
    return bool((found.real > GROWS * np.abs(found)).any())


def first_growth(
    grows_at: Callable[[float], bool], coefficients: Sequence[float], tolerance: float
) -> float | None:
    """The smallest coefficient at which something grows, by bisection behind the first that does.

    Args:
        grows_at: Whether it does at a coefficient.
        coefficients: At which to look first, rising.
        tolerance: To which it is found, absolute.

    Returns:
        The middle of the last interval; the first coefficient where something grows there;
        None where nothing grows at any of them.
    """
    below: float | None = None
    for coefficient in coefficients:
        if grows_at(coefficient):
            break
        below = coefficient
    else:
        return None
    above = coefficient
    if below is None:
        return above
    while above - below > tolerance:
        middle = 0.5 * (below + above)
        if grows_at(middle):
            above = middle
        else:
            below = middle
    return 0.5 * (below + above)


# Sizes of the body that have been slid: friction then turns by nothing when points move sideways.
_FAR = 1e9


class SlidingBody(LinearisedBody):
    """Small changes about a state of sliding; collective, as all its methods.

    Args:
        system: In the state as it was solved, with slip in the directions of sliding.
        body: Its body.

    Raises:
        NotConvergedError: A part of the contact sticks; on every rank.
    """

    def __init__(self, system: CondensedSystem, body: CondensedBody) -> None:
        require_sliding(system.problem)
        far = _FAR * system.problem.spaces.size
        for contact in system.problem.frictional:
            _slide(contact, far)
        super().__init__(system, body)


def require_sliding(problem: Problem) -> None:
    """See that all rough contacts slide wherever they carry pressure; collective.

    Args:
        problem: In the state as it was solved.

    Raises:
        NotConvergedError: One does not, in words with its share; on every rank.
    """
    for contact in problem.frictional:
        owned, weights = contact.trace.owned, contact.trace.weights
        state = contact.state()
        presses = owned & (state.contact_pressure > 0)
        sticks = presses & (state.status != SLIP)
        area, stuck = total(problem.comm, np.array([weights[presses].sum(), weights[sticks].sum()]))
        if stuck > 0:
            raise NotConvergedError(
                f"stability: {stuck / area:.2g} of what carries pressure at '{contact.label}' "
                "sticks, but steady sliding is asked about; let the obstacle or the other body be "
                "moved farther along"
            )


def _slide(contact: ContactSurface, far: float) -> None:
    """Set friction to that of points that have slid far in the direction in which they slip."""
    friction, kinematics = contact.friction, contact.kinematics
    slip: Array = kinematics.tangential(kinematics.jump_at_points())
    counted = friction.effective_slip(slip)
    sizes = np.linalg.norm(counted, axis=1)[:, None]
    direction = np.divide(counted, sizes, out=np.zeros_like(counted), where=sizes > 0)
    friction.accept(slip - far * direction)
    contact.friction_term.follow_pressure()
    contact.follow_pressure()
    contact.friction_term.tangent_state.take_true(slip)


# Of a κ over the largest one found: a rigid motion that nothing holds while it slides.
_NONE = 1e-9


@dataclass(frozen=True, eq=False)
class ComplexMode:
    """A mode that swings and grows, or decays: the real part of φ exp(s t).

    Attributes:
        exponent: s (1/time): its real part is the growth rate, its imaginary part ω ≥ 0.
        shape: φ at the nodes of this rank, (nodes, components), complex; the longest displacement
            is 1 long, and its largest component is real.
    """

    exponent: complex
    shape: Complex


def sliding_modes(
    system: CondensedSystem, body: CondensedBody, number: int, damping: tuple[float, float]
) -> list[ComplexMode]:
    """The modes of the smallest |s|, by their frequencies; collective.

    Args:
        system: In the state as it was solved, in which its contacts slide.
        body: Its body.
        number: How many.
        damping: α (1/time) and β (time) of Rayleigh's.

    Raises:
        InputError: There are not so many.
        NotConvergedError: Some of the contact sticks, a rigid motion is free, or none were found.
    """
    problem = system.problem
    free = int(total(problem.comm, float(problem.free[: problem.spaces.owned_nodes].sum())))
    if number > free // 2:
        raise InputError(
            f"stability.number = {number}: a model of {free} free displacements has not so many "
            f"modes; at most {free // 2}"
        )
    sliding = SlidingBody(system, body)
    served = ServedOperators(problem.spaces, {"mass": _mass(problem), "solve": sliding.solve})

    def on_root(of: Vectors) -> tuple[Complex, Complex]:
        return lowest_squares(served.size, number, of["mass"], of["solve"])

    squares, vectors = served.run(on_root, "stability")
    sizes = np.abs(squares)
    if not np.isfinite(sizes).all() or sizes.min() <= _NONE * sizes.max():
        raise NotConvergedError(
            "stability: a rigid motion is held by nothing while the contact slides, so that its "
            "frequency is 0; hold it by a support or a plane of symmetry"
        )
    found = exponents(squares, *damping)
    order = np.lexsort((-found.real, np.round(found.imag / sizes.max() ** 0.5, 9)))
    return [
        ComplexMode(complex(found[place]), _shape(problem, served, vectors[:, place]))
        for place in order
    ]


def _mass(problem: Problem) -> Callable[[Array], Array]:
    """M u as motions have it, with no rows and columns of what is held; collective."""
    lumped = Mass(problem.scene.material, problem.spaces).lumped()
    masses = ContactMasses(lumped, problem.contacts, problem.spaces, ~problem.free)

    def times(nodal: Array) -> Array:
        return np.asarray(masses.times(nodal * problem.free) * problem.free)

    return times


def _shape(problem: Problem, served: ServedOperators, vector: Complex) -> Complex:
    """At the nodes, scaled; collective."""
    shape = served.at_nodes(vector.real) + 1j * served.at_nodes(vector.imag)
    owned = shape[: problem.spaces.owned_nodes]
    sizes = np.abs(owned).ravel()
    place = int(np.argmax(sizes)) if len(sizes) else 0
    top = largest(problem.comm, sizes)
    mine = (sizes[place], owned.ravel()[place]) if len(sizes) else (0.0, 1.0 + 0j)
    every = of_every_rank(problem.comm, mine)
    most = next(value for size, value in every if size >= top * (1 - 1e-12))
    shape = shape * (most.conjugate() / abs(most))
    # The longest displacement over a period: of a + i b, the major axis of its ellipse.
    owned = shape[: problem.spaces.owned_nodes]
    squares = np.sum(np.abs(owned) ** 2, axis=1)
    longest = np.sqrt(0.5 * (squares + np.abs(np.sum(owned**2, axis=1))))
    return np.asarray(shape / largest(problem.comm, longest))
