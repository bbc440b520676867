"""The law of one point, solved exactly while the forces at all other points are held."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, inf

# Halvings of the interval in which the slip per force is; then it is known to rounding.
_HALVINGS = 200
_ROUNDING = 4e-16


@dataclass(frozen=True)
class OnePoint:
    """Compliance and law of a point, as plain numbers, in scaled units.

    Attributes:
        compliance: Block of W of the point, in rows.
        unilateral: Whether it may open.
        given: Force across where that is given, None where it is not.
        rubs: Whether friction acts along it.
        bonded: Whether it does not slip while it touches.
        elastic: ε, up to which slip is elastic.
    """

    compliance: tuple[tuple[float, ...], ...]
    unilateral: bool
    given: float | None
    rubs: bool
    bonded: bool
    elastic: float

    def solve(self, free: list[float], coefficient: float, fixed: float | None) -> list[float]:
        """Forces at the point.

        Where the gap without forces is open it opens. Else it sticks, or there is a slip per
        force α ≥ 0, v_t = −α r_t, at which the force along is as large as its bound: without slip
        (α = 0) it is larger, and it vanishes as α grows.

        Args:
            free: Gap and slips by the forces at all other points.
            coefficient: Ratio of the bound to the force across.
            fixed: The bound, where it does not depend on the force; None where it does.

        Returns:
            Across (without a force that is given), then along.
        """
        size = len(free) - 1
        if self.unilateral and free[0] >= 0:
            return [0.0] * (size + 1)
        if not (self.rubs or self.bonded):
            across = 0.0 if self.given is not None else -free[0] / self.compliance[0][0]
            return [across] + [0.0] * size
        turned = self._without_across(free)
        if self.bonded:
            return self._at(turned, free, 0.0)
        return self._with_friction(turned, free, coefficient, fixed)

    def _with_friction(
        self,
        turned: tuple[list[list[float]], list[float]],
        free: list[float],
        coefficient: float,
        fixed: float | None,
    ) -> list[float]:
        def excess(alpha: float) -> tuple[float, list[float]]:
            found = self._at(turned, free, alpha)
            across = found[0] if self.given is None else self.given
            bound = coefficient * max(across, 0.0) if fixed is None else fixed
            needed = hypot(*found[1:])
            if self.elastic > 0:
                needed = max(needed, self.elastic / alpha if alpha > 0 else inf)
            return needed - bound, found

        over, found = excess(0.0)
        if over <= 0:
            return found
        low, high = 0.0, 1.0
        while (result := excess(high))[0] > 0 and high < 1e30:
            low, high = high, 4 * high
        found = result[1]
        for _ in range(_HALVINGS):
            middle = (low * high) ** 0.5 if low > 1e-3 * high else 0.5 * (low + high)
            if high - low <= _ROUNDING * high or middle in (low, high):
                break
            over, trial = excess(middle)
            if over > 0:
                low = middle
            else:
                high, found = middle, trial
        return found

    def _without_across(self, free: list[float]) -> tuple[list[list[float]], list[float]]:
        """Compliance and slips along the contact, with the force across eliminated."""
        rows, size = self.compliance, len(free) - 1
        if self.given is not None:
            return [list(row[1:]) for row in rows[1:]], free[1:]
        share = [rows[i + 1][0] / rows[0][0] for i in range(size)]
        inner = [
            [rows[i + 1][j + 1] - share[i] * rows[0][j + 1] for j in range(size)]
            for i in range(size)
        ]
        return inner, [free[i + 1] - share[i] * free[0] for i in range(size)]

    def _at(
        self, turned: tuple[list[list[float]], list[float]], free: list[float], alpha: float
    ) -> list[float]:
        """Forces at a slip per force."""
        inner, slips = turned
        if len(slips) == 1:
            along = [_pushed(slips[0], inner[0][0] + alpha)]
        else:
            (a, b), (c, d) = inner
            a, d = a + alpha, d + alpha
            found = a * d - b * c
            if found == 0:  # a support holds the point along one of the rows, or both
                along = [_pushed(slips[0], a), _pushed(slips[1], d)]
            else:
                pushed = b * slips[1] - d * slips[0], c * slips[0] - a * slips[1]
                along = [one / found for one in pushed]
        if self.given is not None:
            return [0.0, *along]
        row = self.compliance[0]
        pull = sum(row[i + 1] * force for i, force in enumerate(along))
        return [-(free[0] + pull) / row[0], *along]


def _pushed(slip: float, compliance: float) -> float:
    """Force against a slip; none where nothing can move."""
    return -slip / compliance if compliance else 0.0
