"""Damping of bodies that move: Rayleigh's, and boundaries that absorb waves.

C = α M + β K + C_b, and C v̄ acts in a step with its mean velocity v̄ = (u₁ − u₀)/Δt. Across
contacts, where there is no mass, the balance is that of the end of the step: there it is
C (2 v̄ − v̄ of the step before), so that one symmetric matrix serves for all.

C_b are dashpots ρ c_p across the boundary and ρ c_s along it, which take up plane waves that come
straight on (J. Lysmer and R. L. Kuhlemeyer, J. Eng. Mech. Div. ASCE 95 (1969) 859-877).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem
from scipy.sparse import csr_matrix
from ufl.core.expr import Expr

from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.body.elasticity import Isotropic
from fenics_contact.body.mass import Mass
from fenics_contact.body.spaces import Spaces
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import total
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.problem.motion_states import Drag, StepStiffness
from fenics_contact.scene.loading.motion import Motion

Split = Callable[[Array], tuple[Array, Array]]


@dataclass(frozen=True, eq=False)
class Damping:
    """Damping of a motion at its nodes.

    Attributes:
        size: Length of a step (time).
        nodal: α M + C_b, (nodes, components, components), none across contacts (force·time/length).
        of_stiffness: β (time).
        split: Parts of vectors at nodes across contacts, and along them.
    """

    size: float
    nodal: Array
    of_stiffness: float
    split: Split

    def added_to(self, inertial: Array) -> StepStiffness:
        """A of a step, with K and 4 M/Δt²."""
        factor = 2 / self.size
        return StepStiffness(inertial + factor * self.nodal, 1 + factor * self.of_stiffness)

    def pull(self, displacement: Array, internal: Array, before: Drag) -> Array:
        """The part of a step's right-hand side that damping makes (force).

        Args:
            displacement: At its beginning (length).
            internal: K u there (force).
            before: Of the step before.
        """
        across, _ = self.split(before.rate)
        factor = 2 / self.size
        found = factor * (self._nodal(displacement) + self.of_stiffness * internal)
        return np.asarray(found + self.of_stiffness * across)

    def drag(self, moved: Array, internal_change: Array, before: Drag) -> tuple[Array, Drag]:
        """Mean damping force against a step, and the drag of the next; (nodes, components) each.

        Args:
            moved: In the step (length).
            internal_change: Of K u (force).
            before: Of the step before.
        """
        rate = internal_change / self.size
        at_end, _ = self.split(self.of_stiffness * (2 * rate - before.rate))
        _, along = self.split(self._nodal(moved) / self.size + self.of_stiffness * rate)
        return along + 0.5 * (before.across + at_end), Drag(rate, at_end, before.lost)

    def _nodal(self, vectors: Array) -> Array:
        return np.asarray(np.einsum("nij,nj->ni", self.nodal, vectors))


def damping_of(
    motion: Motion, mass: Array, density: Mass, elastic: ElasticBody, spaces: Spaces, split: Split
) -> Damping | None:
    """The damping of a motion; None where nothing damps; collective.

    Args:
        motion: Of the scene.
        mass: Of the nodes, (nodes, components, components).
        density: Of the body.
        elastic: The body, for the speeds of its waves.
        spaces: Likewise.
        split: As of ``Damping``.

    Raises:
        InputError: A boundary that absorbs is none of the body, or its material is not isotropic.
    """
    rayleigh = motion.rayleigh
    if rayleigh is None and not motion.absorbing:
        return None
    nodal = np.zeros_like(mass) if rayleigh is None else rayleigh.mass * mass
    for name in motion.absorbing:
        group = spaces.body.boundary(name, "motion.absorbing")
        nodal = nodal + _along(_dashpots(group, density, elastic, spaces), split)
    return Damping(motion.size, nodal, 0.0 if rayleigh is None else rayleigh.stiffness, split)


def _along(blocks: Array, split: Split) -> Array:
    """The part of symmetric blocks at the nodes that acts along contacts on what moves so."""
    for _ in range(2):
        parts = [split(column)[1] for column in np.moveaxis(blocks, 2, 0)]
        blocks = np.stack(parts, axis=1)  # transposed: rows come next
    return blocks


def _dashpots(group: Group, density: Mass, elastic: ElasticBody, spaces: Spaces) -> Array:
    """C_b at the nodes, (nodes, components, components) (force·time/length); collective.

    The part of the consistent matrix that couples nodes goes to its diagonal, so that a boundary
    that moves as a whole is resisted as it should be.
    """
    law = elastic.law
    if not isinstance(law, Isotropic):
        raise InputError(
            "motion.absorbing: the speeds of waves are known of isotropic materials alone; hold or "
            "free these boundaries instead"
        )
    across, along = _impedances(law, density, spaces.kinematics == "plane stress")
    normal = ufl.FacetNormal(spaces.body.mesh)
    u = ufl.TrialFunction(spaces.displacement_space)
    v = ufl.TestFunction(spaces.displacement_space)
    pushed = ufl.dot(u, normal) * ufl.dot(v, normal)
    resisted = across * pushed + along * (ufl.dot(u, v) - pushed)
    form = form_cache.form(spaces.weight * resisted * spaces.boundary(group))
    matrix = csr_matrix(fem.assemble_matrix(form).to_scipy(ghosted=True))
    blocks = _diagonal_blocks(matrix, len(spaces.coordinates), spaces.components)
    flat = spaces.summed(blocks.reshape(len(blocks), spaces.components**2)).reshape(blocks.shape)
    own = slice(spaces.owned_nodes)
    # The trace of all of it: dashpots of every component that moves by 1.
    here = total(spaces.comm, float(np.einsum("nii->", flat[own])))
    whole = spaces.weight * (across + (spaces.components - 1) * along) * spaces.boundary(group)
    asked = total(spaces.comm, float(fem.assemble_scalar(form_cache.form(whole))))
    return np.asarray(flat * (asked / here))


def _impedances(law: Isotropic, density: Mass, is_plane_stress: bool) -> tuple[Expr, Expr]:
    """ρ c_p and ρ c_s, UFL (force·time/length³)."""
    rho = density.density
    return ufl.sqrt(rho * law.wave_modulus(is_plane_stress)), ufl.sqrt(rho * law.shear_modulus)


def _diagonal_blocks(matrix: csr_matrix, nodes: int, size: int) -> Array:
    """Blocks that couple the components of one node, (nodes, size, size)."""
    found = np.zeros((nodes, size, size))
    rows, columns = np.divmod(np.arange(matrix.shape[0]), size)
    for other in range(size):
        there = rows * size + other
        found[rows, columns, other] = np.asarray(matrix[np.arange(len(rows)), there]).ravel()
    return found
