"""Complex modes about a state of steady sliding."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fenics_contact.analyses.stability.flutter import Complex, exponents, lowest_squares
from fenics_contact.analyses.stability.sliding_body import SlidingBody
from fenics_contact.body.mass import Mass
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError, NotConvergedError
from fenics_contact.common.parallel import largest, of_every_rank, total
from fenics_contact.problem.inertia.massless import ContactMasses
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.modes.served import ServedOperators, Vectors

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
