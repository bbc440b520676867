"""How far Newton's method goes along its steps, as options of PETSc; when that is no way."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

# Full steps are best from the adhesive start with the primal-dual tangent, where searches only
# cost steps or stall in round-off. One-sided contact needs a search on the energy: for a point
# along the step where its derivative vanishes, which takes no difference of nearly equal energies.
FULL_STEPS: dict[str, Any] = {"snes_linesearch_type": "basic"}
# Its absolute tolerance would be in the user's units, and end a solve behind our back.
ENERGY_SEARCH: dict[str, Any] = {
    "snes_linesearch_type": "cp",
    "snes_linesearch_max_it": 3,
    "snes_linesearch_atol": 1e-300,
}
# Where that does not come near enough to the point, as with very flat cells, or with a slender
# body that would bend far through an obstacle: steps are cut before they are taken.
THOROUGH_SEARCH = dict(FULL_STEPS)

# Newton steps of the energy search at the most; and how many of them are to bring the imbalance
# to which share of the least before.
QUICK = 50
_LATELY, _FALLS = 5, 0.1
# Newton steps under each of several softer penalties: the next one begins where they end.
ON_THE_WAY = 4


def comes_no_nearer(imbalances: Sequence[float]) -> bool:
    """Whether the last steps of a search brought nothing, as where most of them are cut short.

    Args:
        imbalances: Before every step of the solve so far, the present one last (force).
    """
    if len(imbalances) <= 2 * _LATELY:
        return False
    return min(imbalances[-_LATELY:]) > _FALLS * min(imbalances[:-_LATELY])
