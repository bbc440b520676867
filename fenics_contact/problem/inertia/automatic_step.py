"""The time step of a motion that leaves it to the program: a wave passes a cell in it.

The scheme bears longer steps, but what a shorter one could show, the mesh does not: a wave is told
from its neighbours by cells, or by nodes. So it is the time in which a pressure wave passes a cell,
over the degree of its polynomials: the median, by volume, of all cells, since few small ones, as at
a fillet, are worth no shorter step.
"""

from __future__ import annotations

import logging
import math
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
from fenics_contact.scene.loading.motion import MOST_STEPS
from fenics_contact.scene.scene import Scene

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
