"""The lowest modes of M and K by SciPy's ARPACK, and those about a state whose contacts stick.

Rank 0 has the vectors. Shift and invert about 0: a step of Lanczos' method is a product with M and
a solve with K.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh

from fenics_contact.analyses.vibration.record import ModeRecord
from fenics_contact.body.mass import Mass
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError, NotConvergedError
from fenics_contact.common.parallel import largest, total
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.free_modes import LinearisedBody, Nodal, ServedOperators, Vectors

# Of eigenvalues: beyond what meshes are worth, and within what round-off allows.
_ACCURATE = 1e-9
# Lanczos vectors beside two a mode: the lowest modes lie far apart, and each vector is a solve.
_MORE = 6
# Of an eigenvalue over the largest: a rigid motion that nothing holds.
_NONE = 1e-10


@dataclass(frozen=True, eq=False)
class Mode:
    """A natural mode.

    Attributes:
        circular_frequency: ω (1/time).
        shape: Displacements at the nodes of this rank, (nodes, components); the largest is 1 long.
        forces: M times that (mass).
        mass: Of a unit amplitude of the largest displacement (mass).
    """

    circular_frequency: float
    shape: Array
    forces: Array
    mass: float


class Eigenmodes:
    """Modes of a body; collective, as all its methods.

    Args:
        spaces: Of the body.
        times_mass: M u of nodal displacements, with no rows and columns of what is held.
        solve: K⁻¹ f of nodal forces.
    """

    def __init__(self, spaces: Spaces, times_mass: Nodal, solve: Nodal) -> None:
        self._spaces, self._comm = spaces, spaces.comm
        self._times_mass = times_mass
        self._served = ServedOperators(spaces, {"mass": times_mass, "solve": solve})

    def lowest(self, number: int, free: int) -> list[Mode]:
        """The modes of the lowest frequencies, in their order.

        Args:
            number: How many.
            free: Number of displacements of all ranks that nothing holds.

        Raises:
            InputError: There are not so many.
            NotConvergedError: ARPACK did not find them, or a rigid motion is free.
        """
        if number > free // 2:
            raise InputError(
                f"modes.number = {number}: a model of {free} free displacements has not so many; "
                f"at most {free // 2}"
            )
        values, vectors = self._served.run(lambda of: self._on_root(of, number), "modes")
        if not np.isfinite(values).all() or values.min() <= _NONE * values.max():
            raise NotConvergedError(
                "modes: a rigid motion is held by nothing, so that its frequency is 0; hold it "
                "by a support"
            )
        return [self._mode(*pair) for pair in zip(values, vectors.T, strict=True)]

    def _on_root(self, of: Vectors, number: int) -> tuple[Array, Array]:
        """ω² and the shapes, by rank 0 alone."""
        size = self._served.size
        operators = {
            name: LinearOperator((size, size), matvec=times, dtype=np.float64)
            for name, times in of.items()
        }
        start = of["solve"](of["mass"](np.random.default_rng(0).normal(size=size)))
        values, vectors = eigsh(
            operators["mass"],  # of K only the shape is asked
            k=number,
            M=operators["mass"],
            sigma=0.0,
            OPinv=operators["solve"],
            v0=start,
            ncv=min(size, 2 * number + _MORE),
            tol=_ACCURATE,
        )
        order = np.argsort(values)
        return np.asarray(values[order]), np.asarray(vectors[:, order])

    def _mode(self, value: float, vector: Array) -> Mode:
        """With the largest displacement 1 long, and its largest component > 0."""
        shape = self._served.at_nodes(vector)
        owned = shape[: self._spaces.owned_nodes]
        shape = shape / largest(self._comm, np.linalg.norm(owned, axis=1))
        most = largest(self._comm, owned.max(initial=0.0).reshape(1))
        least = largest(self._comm, -owned.min(initial=0.0).reshape(1))
        shape = shape if most >= least * (1 - 1e-6) else -shape
        forces = self._times_mass(shape)
        work = np.sum(shape * forces, axis=1)[: self._spaces.owned_nodes]
        mass = float(total(self._comm, work.sum()))
        return Mode(float(np.sqrt(value)), shape, forces, mass)


def stuck_modes(system: CondensedSystem, body: CondensedBody, number: int) -> list[Mode]:
    """The lowest modes; collective.

    Args:
        system: At the begin of the load step that would come next.
        body: Its body.
        number: How many.

    Raises:
        InputError: There are not so many.
        NotConvergedError: They were not found, or a rigid motion is free.
    """
    problem = system.problem
    if problem.stabilisation:
        raise NotConvergedError(
            "modes: a rigid motion is held by nothing, so that its frequency is 0; hold it by a "
            "support"
        )
    mass, free = Mass(problem.scene.material, problem.spaces), problem.free
    free.reshape(-1)[problem.coupled] = True  # these move with their points
    problem.stick_all()  # what carries pressure has the stiffness of contact, and of stick
    stuck = LinearisedBody(system, body)

    def times_mass(nodal: Array) -> Array:
        moved = nodal * free
        return (mass.times(moved) + problem.momentum_of_points(moved)) * free

    count = int(total(problem.comm, float(free[: problem.spaces.owned_nodes].sum())))
    return Eigenmodes(problem.spaces, times_mass, stuck.solve).lowest(number, count)


def mode_records(modes: Sequence[Mode]) -> list[ModeRecord]:
    """Return the modes as ``result.json`` has them.

    Args:
        modes: In their order.
    """
    return [
        ModeRecord(
            number=number,
            natural_frequency=mode.circular_frequency / (2 * math.pi),
            modal_mass=mode.mass,
        )
        for number, mode in enumerate(modes, start=1)
    ]
