"""The contact problem of a condensed body, as arrays: forces at contact points, and their gaps.

Gaps and slips follow from the forces by v = W r + q. Rows stand point by point: one across the
contact, then one along it in the plane, two in space. After all points come rows of scalars, such
as the position of an obstacle that a force drives: their v is 0, and their r may have any sign.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Words
from fenics_contact.solve.exact.scaling import Scaling, scaled

UNILATERAL, BONDED, GIVEN = "unilateral", "bonded", "given"
COULOMB, NONE = "coulomb", "none"
ACROSS, ALONG = (UNILATERAL, BONDED, GIVEN), (COULOMB, NONE, BONDED)

# Forces across the contact, (points,) (force) → bound of friction (force) and its slope (points,).
BoundRule = Callable[[Array], tuple[Array, Array]]


@dataclass(frozen=True, eq=False)
class PointLaws:
    """The laws at the contact points, as arrays with one entry for each point.

    Across the contact a point is unilateral (r_n ≥ 0, v_n ≥ 0, r_n v_n = 0), bonded (v_n = 0), or
    its force is given. Along it, r_t = −g v_t/|v_t| where it slips, |r_t| ≤ g where it sticks, with
    g = μ max(r_n, 0); or no force acts; or it is bonded, which holds while it touches.

    Attributes:
        coefficient: Friction coefficient μ, (points,).
        across: ``"unilateral"``, ``"bonded"`` or ``"given"``, (points,); all unilateral if None.
        along: ``"coulomb"``, ``"none"`` or ``"bonded"``, (points,); all Coulomb if None.
        bound: Bound g as a function of the forces across all points, in place of μ r_n. It is
            called with forces ≥ 0, and the bound at a point may depend on the force there alone.
        fixed_bound: Bound g where friction does not depend on the force, (points,) (force); NaN at
            points where it does. None if it does everywhere.
        given_force: Force across where it is given, (points,) (force).
        series_compliance: c of a layer between the surfaces: v_n + c r_n takes the place of v_n,
            (points,) (length/force).
        elastic_slip: ε up to which slip is elastic: r_t = −g v_t/ε for |v_t| ≤ ε, (points,)
            (length).
        metric: How friction feels slip: r_t = −g M (M v_t)/|M v_t|, with M symmetric and regular,
            (points, 2, 2); for the unit matrix if None.
    """

    coefficient: Array
    across: Words | None = None
    along: Words | None = None
    bound: BoundRule | None = None
    fixed_bound: Array | None = None
    given_force: Array | None = None
    series_compliance: Array | None = None
    elastic_slip: Array | None = None
    metric: Array | None = None

    @cached_property
    def number(self) -> int:
        """Number of points."""
        return len(self.coefficient)

    @cached_property
    def unilateral(self) -> Flags:
        """Points that may open, (points,)."""
        return self._are(self.across, UNILATERAL, default=True)

    @cached_property
    def given(self) -> Flags:
        """Points at which the force across is given, (points,)."""
        return self._are(self.across, GIVEN)

    @cached_property
    def rubs(self) -> Flags:
        """Points with a bound of friction, (points,)."""
        return self._are(self.along, COULOMB, default=True)

    @cached_property
    def bonded_along(self) -> Flags:
        """Points that do not slip while they touch, (points,)."""
        return self._are(self.along, BONDED)

    @cached_property
    def forces(self) -> Array:
        """Forces that are given, 0 elsewhere, (points,)."""
        nothing = np.zeros(self.number)
        return nothing if self.given_force is None else np.where(self.given, self.given_force, 0.0)

    @cached_property
    def elastic(self) -> Array:
        """ε of each point, 0 where no slip is elastic, (points,)."""
        return np.zeros(self.number) if self.elastic_slip is None else self.elastic_slip

    def bounds(self, forces: Array) -> tuple[Array, Array]:
        """Bound of friction at each point and its slope in the force there.

        Args:
            forces: Across the contact, ≥ 0, (points,) (force).

        Returns:
            (points,) each (force; –).
        """
        if self.bound is None:
            found, slope = self.coefficient * forces, self.coefficient
        else:
            found, slope = self.bound(forces)
        if self.fixed_bound is None:
            return found, slope
        follows = np.isnan(self.fixed_bound)
        return np.where(follows, found, self.fixed_bound), np.where(follows, slope, 0.0)

    def _are(self, words: Words | None, kind: str, default: bool = False) -> Flags:
        return np.full(self.number, default) if words is None else np.asarray(words) == kind


@dataclass(frozen=True, eq=False)
class LocalProblem:
    """v = W r + q with the laws of the points, and v = 0 in the rows of scalars.

    The across row of v is the gap that is left (≥ 0), that of r the compressive force (≥ 0). Along
    rows of v are slips from their reference, which q contains; those of r are the friction forces
    on the body.

    Attributes:
        compliance: W, (rows, rows) (length/force); need not be symmetric.
        free: q, the gaps and slips without forces, (rows,) (length).
        laws: Of the points.
        weights: Area of each point, (points,); 1 each if None. Of several answers by a singular W
            it is the one with the least Σ r²/A that counts.
        scalars: Number of rows after those of the points.
    """

    compliance: Array
    free: Array
    laws: PointLaws
    weights: Array | None = None
    scalars: int = 0

    def __post_init__(self) -> None:
        rows, points = len(self.free), self.laws.number
        if self.compliance.shape != (rows, rows):
            raise ValueError(f"compliance has the shape {self.compliance.shape}, free {rows} rows")
        if points == 0 or (rows - self.scalars) not in (2 * points, 3 * points):
            raise ValueError(f"{rows} rows, {self.scalars} of scalars, do not fit {points} points")
        kinds = ((self.laws.across, ACROSS), (self.laws.along, ALONG))
        for given, known in kinds:
            if given is not None and not set(np.unique(given)) <= set(known):
                raise ValueError(f"laws {sorted(set(given))}: known are {known}")

    @property
    def points(self) -> int:
        """Number of points."""
        return self.laws.number

    @property
    def dimension(self) -> int:
        """Rows of a point: 2 in the plane, 3 in space."""
        return (len(self.free) - self.scalars) // self.points

    @cached_property
    def scaling(self) -> Scaling:
        """The problem's compliance in the units that the solver works with."""
        laws = self.laws
        of_laws = (laws.series_compliance, laws.metric)
        return scaled(self.compliance, self.points, self.dimension, *of_laws)

    def with_free(self, free: Array) -> LocalProblem:
        """Return the problem with other gaps without forces; what was derived from W is kept.

        Args:
            free: q, (rows,) (length).
        """
        return self.with_laws(self.laws, free)

    def with_laws(self, laws: PointLaws, free: Array | None = None) -> LocalProblem:
        """Return the problem with other laws, such as another coefficient of friction.

        What was derived from W is kept where neither the layers nor the metric differ.

        Args:
            laws: At the same points.
            free: q, (rows,) (length); by default the same.
        """
        known = self.laws
        # Words are looked through only where they differ, which takes longer than to compare them.
        same_words = _are_equal(laws.across, known.across) and _are_equal(laws.along, known.along)
        found = copy(self) if same_words else replace(self, laws=laws)
        found.__dict__.update(laws=laws, free=self.free if free is None else free)
        layers = _are_equal(laws.series_compliance, known.series_compliance)
        if "scaling" in self.__dict__ and layers and _are_equal(laws.metric, known.metric):
            found.__dict__["scaling"] = self.scaling
        else:
            found.__dict__.pop("scaling", None)
        return found


def _are_equal(one: Array | Words | None, other: Array | Words | None) -> bool:
    """Whether two arrays, or their absence, are the same."""
    if one is None or other is None:
        return one is other
    return np.array_equal(one, other)
