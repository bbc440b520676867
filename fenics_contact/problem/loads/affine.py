"""Loads that are linear in the place: t = a + B (x − c), about the centroid c of what they act on.

Their nodal forces follow from ∫ φ and ∫ (x − c) φ, which are assembled once, whatever a and B are.
Since the displacements of rigid motions are in the space of the elements, sums over nodes are then
the integrals by the same rule: resultants are what they are meant to be up to round-off.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fenics_contact.body.spaces import Spaces
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.problem.loads.acting_load import ActingLoad


def linear_field(spaces: Spaces, uniform: Array, linear: Array, origin: Array) -> Expr:
    """Return a + B (x − c) in UFL, whose numbers are constants that no compiled form depends on.

    Args:
        spaces: Those of the body.
        uniform: a, (components,).
        linear: B, (components, components).
        origin: c, (components,) (length).
    """
    mesh = spaces.body.mesh
    a, b, c = (fem.Constant(mesh, np.array(each, float)) for each in (uniform, linear, origin))
    return a + ufl.dot(b, spaces.position - c)


def rotations(components: int) -> Array:
    """Return the matrices R of small rotations R r about each axis; in the plane there is one.

    Returns:
        (axes, components, components).

    >>> rotations(2).tolist()
    [[[0.0, -1.0], [1.0, 0.0]]]
    """
    if components == 2:
        return np.array([[[0.0, -1.0], [1.0, 0.0]]])
    axes = np.eye(3)
    return np.asarray(np.cross(axes[:, None], axes[None]).transpose(0, 2, 1))


@dataclass(frozen=True, eq=False)
class Moments:
    """Integrals of weight and place over what a load acts on.

    Attributes:
        zeroth: ∫ w φ at this rank's nodes, (nodes,).
        first: ∫ w (x − c) φ at these, (nodes, components).
        size: ∫ w, such as an area or a mass.
        centroid: c, (components,) (length).
        spaces: Those of the body.
    """

    zeroth: Array
    first: Array
    size: float
    centroid: Array
    spaces: Spaces

    @classmethod
    def of(
        cls, weight: Expr, measure: ufl.Measure, spaces: Spaces, about: Array | None = None
    ) -> Moments:
        """Return the integrals over a measure; collective.

        Args:
            weight: w, besides the weight of all integrals of the model.
            measure: Of what the load acts on.
            spaces: Those of the body.
            about: A point to take in place of the centroid (length).
        """
        size = spaces.components
        mesh = spaces.body.mesh
        a, c = (fem.Constant(mesh, np.zeros(size)) for _ in range(2))
        b = fem.Constant(mesh, np.zeros((size, size)))
        test = ufl.TestFunction(spaces.displacement_space)
        field = weight * (a + ufl.dot(b, spaces.position - c))
        form = form_cache.form(spaces.weight * ufl.dot(field, test) * measure)
        a.value[0] = 1.0
        zeroth = spaces.assemble(form)[:, 0]
        own = slice(spaces.owned_nodes)
        places = spaces.coordinates[own, :size]
        sums = np.array([zeroth[own].sum(), *(zeroth[own, None] * places).sum(axis=0)])
        sums = np.asarray(total(spaces.comm, sums))
        c.value[:] = sums[1:] / sums[0] if about is None else about
        a.value[0], b.value[:] = 0.0, np.eye(size)
        return cls(zeroth, spaces.assemble(form), float(sums[0]), np.array(c.value), spaces)

    @property
    def arms(self) -> Array:
        """Place of each owned node from the centroid, (nodes, components) (length)."""
        spaces = self.spaces
        places = spaces.coordinates[: spaces.owned_nodes, : spaces.components]
        return np.asarray(places - self.centroid)

    @cached_property
    def second(self) -> Array:
        """∫ w (R r) · (R' r) of small rotations R and R' about c, (axes, axes); collective."""
        turns, first = rotations(self.spaces.components), self.first[: self.spaces.owned_nodes]
        parts = np.einsum("kij,nj,lim,nm->kl", turns, self.arms, turns, first, optimize=True)
        return np.asarray(total(self.spaces.comm, parts))

    def nodal(self, uniform: Array, linear: Array) -> Array:
        """Return the nodal forces of a + B (x − c), (nodes, components) (force).

        Args:
            uniform: a, (components,).
            linear: B, (components, components).
        """
        return np.asarray(np.outer(self.zeroth, uniform) + self.first @ linear.T)

    def resultants(self, nodal: Array) -> tuple[Array, Array]:
        """Return sum of nodal forces and their moments about the centroid; collective.

        Args:
            nodal: Forces, (nodes, components) (force).
        """
        forces, turns = nodal[: self.spaces.owned_nodes], rotations(self.spaces.components)
        moments = np.einsum("kij,nj,ni->k", turns, self.arms, forces, optimize=True)
        sums = np.concatenate([forces.sum(axis=0), moments])
        found: Array = np.asarray(total(self.spaces.comm, sums))
        return found[: self.spaces.components], found[self.spaces.components :]


@dataclass(frozen=True, eq=False)
class AffineLoad(ActingLoad):
    """A load a + B (x − c) times a weight, such as a density.

    Attributes:
        uniform: a, (components,).
        linear: B, (components, components).
        moments: Of the weight.
    """

    uniform: Array
    linear: Array
    moments: Moments

    @property
    def weight(self) -> Expr:
        """Weight of the field, in UFL."""
        return ufl.as_ufl(1.0)

    @property
    def force(self) -> Expr:
        """Force over area or volume, a UFL vector."""
        centre = self.moments.centroid
        return self.weight * linear_field(self.spaces, self.uniform, self.linear, centre)

    def nodal(self) -> Array:
        """Nodal forces by the moments, (nodes, components) (force)."""
        return self.moments.nodal(self.uniform, self.linear)
