"""How friction feels slip: as it is, or longer along one direction of the surface than another.

The potential of friction is g φ_ε(M s), with M linear and symmetric along the surface: its traction
is −g M q, |q| ≤ 1, along M s where the point slips. For M = 1 that is Coulomb's circle; other M
make it an ellipse, with the rule of sliding that is associated to it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property, lru_cache

import numpy as np
import ufl
from ufl.core.expr import Expr

from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.point_values import PointDensity, point_density
from fenics_contact.contact.surface.trace import Trace

# Of the bound: a traction that has no direction but that of round-off.
_NO_TRACTION = 1e-9


class SlipMetric:
    """M at the points of a contact; this one is 1, and others say what they do instead.

    Attributes:
        fields: Parameters of ``scaled`` at the points, by name, (points,) or (points, components).
    """

    fields: Mapping[str, Array] = {}

    @staticmethod
    def scaled(vector: Expr, **fields: Expr) -> Expr:
        """M times a vector along the surface, in UFL.

        Args:
            vector: Such as a slip.
            fields: As ``fields`` names them.
        """
        return vector

    def at(self, vectors: Array) -> Array:
        """M times vectors along the surface at the points, (points, components)."""
        return vectors

    def at_each(self, vectors: Array) -> Array:
        """M times several vectors at each point, (points, components, vectors)."""
        return vectors

    def undone(self, vectors: Array) -> Array:
        """M⁻¹ times vectors along the surface at the points, (points, components)."""
        return vectors

    def carried(self, tractions: Array) -> Array:
        """The bound that it takes to carry tractions along the surface, (points,) (stress).

        |M⁻¹ t|: they are within friction's bound where that is at least as large.

        Args:
            tractions: At the points, (points, components) (stress).
        """
        return np.asarray(np.linalg.norm(tractions, axis=1))

    def bound_along(self, bound: Array, tractions: Array) -> Array:
        """The largest traction along the directions of some, at the points, (points,) (stress).

        Args:
            bound: g, (points,) (stress).
            tractions: Along the surface, (points, components) (stress).
        """
        return bound

    @property
    def least(self) -> Array:
        """The smallest |M s| of slips of length 1, at the points, (points,) or one for all."""
        return np.ones(1)

    @property
    def squared(self) -> Array | None:
        """M² at the points, (points, components, components); None where it is 1."""
        return None

    def gradients(self, tests: Array, vectors: Array) -> Mapping[str, Array]:
        """Derivatives of test · M vector in the parameters of ``fields``, by name.

        Args:
            tests: Along the surface at the points, (points, components).
            vectors: Likewise.
        """
        return {}

    @property
    def sizes(self) -> dict[str, int]:
        """Number of components of each of ``fields``, 0 of scalars, for ``point_density``."""
        return {name: of.shape[1] if of.ndim == 2 else 0 for name, of in self.fields.items()}

    def in_ufl(self, trace: Trace) -> Callable[[Expr], Expr]:
        """M on the surface, for forms; collective."""
        fields = {
            name: trace.function(values).ufl if values.ndim == 2 else trace.coefficient(values)
            for name, values in self.fields.items()
        }
        return lambda vector: self.scaled(vector, **fields)


class OwnMetric(SlipMetric):
    """M by parameters at the points: a class derived from it says ``scaled``.

    Args:
        fields: As of ``SlipMetric``.
        slips: Any at the points, (points, components).
    """

    def __init__(self, fields: Mapping[str, Array], slips: Array) -> None:
        self.fields, self._like = fields, slips

    def at(self, vectors: Array) -> Array:
        """M times vectors along the surface at the points, (points, components)."""
        return np.asarray(np.einsum("pij,pj->pi", self.matrices, vectors))

    def at_each(self, vectors: Array) -> Array:
        """M times several vectors at each point, (points, components, vectors)."""
        return np.asarray(self.matrices @ vectors)

    def carried(self, tractions: Array) -> Array:
        """Length |M⁻¹ t|."""
        return np.asarray(np.linalg.norm(self.undone(tractions), axis=1))

    def undone(self, vectors: Array) -> Array:
        """M⁻¹ times vectors along the surface at the points, (points, components)."""
        return np.asarray(np.linalg.solve(self.matrices, vectors[..., None])[..., 0])

    def bound_along(self, bound: Array, tractions: Array) -> Array:
        """G |t|/|M⁻¹ t|; in all directions the least of M where there is no traction."""
        size, carried = np.linalg.norm(tractions, axis=1), self.carried(tractions)
        known = size > _NO_TRACTION * bound
        shares = size / np.where(known, carried, 1.0)
        return np.asarray(bound * np.where(known, shares, self.least))

    @cached_property
    def matrices(self) -> Array:
        """M, also across the surface, (points, components, components)."""
        vectors = dict.fromkeys(("test", "vector"), np.zeros_like(self._like))
        return self._pairings.curvatures("test", "vector", **vectors, **self.fields)

    def gradients(self, tests: Array, vectors: Array) -> Mapping[str, Array]:
        """Derivatives of test · M vector in the parameters of ``fields``, by name."""
        values = {"test": tests, "vector": vectors, **self.fields}
        return {name: self._pairings.slope(name, **values) for name in self.fields}

    @property
    def _pairings(self) -> PointDensity:
        """Test · M vector at the points."""
        sizes = dict.fromkeys(("test", "vector"), self._like.shape[1]) | self.sizes
        return point_density(_pairing(self.scaled), **sizes)

    @property
    def squared(self) -> Array:
        """Square M²."""
        return self.matrices @ self.matrices

    @cached_property
    def least(self) -> Array:
        """The least of M's principal values."""
        return np.asarray(np.linalg.eigvalsh(self.matrices).min(axis=1))


@lru_cache
def _pairing(scaled: Callable[..., Expr]) -> Callable[..., Expr]:
    def density(test: Expr, vector: Expr, **fields: Expr) -> Expr:
        return ufl.dot(test, scaled(vector, **fields))

    return density
