"""The inertia of a problem, at rest or in a step of motion, and how long such a step is.

The inertia of a problem: none of bodies at rest, a step of motion of those that move. A problem
asks its inertia the same of both: what load is in balance, what an imbalance is small against, and
what there is when the load steps begin.

The time step of a motion that leaves it to the program: a wave passes a cell in it. The scheme
bears longer steps, but what a shorter one could show, the mesh does not: a wave is told from its
neighbours by cells, or by nodes. So it is the time in which a pressure wave passes a cell, over
the degree of its polynomials: the median, by volume, of all cells, since few small ones, as at a
fillet, are worth no shorter step.
"""

from __future__ import annotations

import logging
import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import ufl
from dolfinx import fem

from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.body.mass import density_of
from fenics_contact.body.spaces import Spaces
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import from_root, gathered_on_root
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.problem.motion_states import FirstState, StepStiffness
from fenics_contact.scene.loading.motion import MOST_STEPS
from fenics_contact.scene.scene import Scene


class Inertia(ABC):
    """Masses of a problem, or none.

    Attributes:
        moves: Whether bodies move, so that masses take what loads and contacts leave.
        size: Length of a step (time); None of bodies at rest.
        stiffness: The matrix of a step; None where it is K.
        first: What there is at time 0.
        most_open: Share of the energy brought in that steps may leave open at the most.
    """

    moves: bool
    size: float | None
    stiffness: StepStiffness | None
    first: FirstState
    most_open: float

    @property
    @abstractmethod
    def displacement(self) -> Array | float:
        """Where the present step begins, (nodes, components), or 0 of a body at rest (length)."""

    @property
    @abstractmethod
    def motions(self) -> Array:
        """How far what stands opposite has moved when the step begins, (contacts, components)."""

    @property
    @abstractmethod
    def energy(self) -> float:
        """Energy stored at time 0, and kinetic energy when the step begins (energy); collective."""

    @abstractmethod
    def follow_points(self) -> None:
        """Give points of couplings what the step begins from, once these have its time."""

    @abstractmethod
    def follow_velocities(self) -> None:
        """Let friction count from where no velocity is left at the end of the step; collective."""

    @abstractmethod
    def effective_load(self, load: Array) -> Array:
        """The right-hand side of the balance, but for contacts that press and rub (force).

        Args:
            load: That is given, at the end of a step of motion (force).
        """

    @abstractmethod
    def applied(self, effective: Array, load: Array) -> Array:
        """Sizes of the forces at the nodes that an imbalance is small against (force).

        Args:
            effective: The load of the balance that is solved.
            load: The one that is given.
        """


class AtRest(Inertia):
    """The inertia of bodies that have none: loads, contacts and supports are in balance.

    Args:
        contacts: Those of the problem.
        spaces: Those of the body.
    """

    moves = False
    size = None
    stiffness = None
    most_open = math.inf

    def __init__(self, contacts: Sequence[ContactSurface], spaces: Spaces) -> None:
        count = len(contacts)
        self.first = FirstState(0.0, np.zeros((count, spaces.components)), (0.0,) * count)

    @property
    def displacement(self) -> float:
        """0: load steps begin where the body is undeformed (length)."""
        return 0.0

    @property
    def energy(self) -> float:
        """Zero: bodies at rest have none (energy)."""
        return 0.0

    @property
    def motions(self) -> Array:
        """None, (contacts, components) (length)."""
        return np.zeros_like(self.first.pressures)

    def follow_points(self) -> None:
        """They begin from nothing."""

    def follow_velocities(self) -> None:
        """There are none."""

    def effective_load(self, load: Array) -> Array:
        """The load itself."""
        return load

    def applied(self, effective: Array, load: Array) -> Array:
        """Sizes of the loads."""
        return np.abs(effective)


logger = logging.getLogger(__name__)

# The step is rounded down to so many digits: so it is the same on any number of ranks.
_DIGITS = 2


def with_time_step(scene: Scene, elastic: ElasticBody, spaces: Spaces) -> Scene:
    """The scene with a number in place of an automatic time step; collective.

    Args:
        scene: Of bodies that move, or not.
        elastic: Their stiffness.
        spaces: On their mesh.

    Raises:
        InputError: It would take too many steps, or a material has no density.
    """
    motion = scene.motion
    if motion is None or motion.step != "automatic":
        return scene
    passing = _passing_times(scene, elastic, spaces)
    rows = gathered_on_root(spaces.comm, passing)
    middle = (
        None if rows is None else _median(*(np.concatenate(p) for p in zip(*rows, strict=True)))
    )
    step = from_root(spaces.comm, middle)
    assert step is not None
    step = min(_rounded_down(step), float(motion.end))
    if motion.end / step > MOST_STEPS:
        raise InputError(
            f"motion.step = 'automatic': a wave passes a cell in {step:g}, so that it would take "
            f"more than {MOST_STEPS} steps to end = {motion.end:g}; give a step or an earlier end, "
            "or make cells larger"
        )
    found = replace(motion, step=step)
    logger.info("time step %g, in which a wave passes a cell: %d steps", step, found.steps.number)
    return replace(scene, motion=found)


def _passing_times(scene: Scene, elastic: ElasticBody, spaces: Spaces) -> tuple[Array, Array]:
    """Time that a wave takes from node to node in each cell of this rank, and its volume."""
    mesh = spaces.body.mesh
    density = density_of(scene.material, spaces)
    modulus = elastic.law.wave_modulus(scene.kinematics == "plane stress")
    constants = fem.functionspace(mesh, ("DG", 0))
    test, measure = ufl.TestFunction(constants), ufl.dx(metadata={"quadrature_degree": 2})
    volumes, slow = (
        fem.assemble_vector(form_cache.form(factor * test * measure)).array
        for factor in (ufl.as_ufl(1.0), ufl.sqrt(density / modulus))
    )
    own = constants.dofmap.index_map.size_local
    volumes, slow = volumes[:own], slow[:own]
    sizes = volumes ** (1 / spaces.body.dimension)
    return sizes * slow / volumes / spaces.degree, volumes


def _median(values: Array, weights: Array) -> float:
    """Half of the weights belong to values that are not larger."""
    order = np.argsort(values)
    below = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(below, 0.5 * below[-1])])


def _rounded_down(value: float) -> float:
    unit = 10.0 ** (math.floor(math.log10(value)) + 1 - _DIGITS)
    return math.floor(value / unit * (1 + 1e-9)) * unit
