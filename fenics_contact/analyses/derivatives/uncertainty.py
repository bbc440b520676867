"""Uncertainty of quantities by tolerances of a scene's numbers, next to the numerical error."""

from __future__ import annotations

import math
from collections.abc import Mapping

from fenics_contact.analyses.derivatives.record import Derivative, Uncertainty
from fenics_contact.results.result import Result
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.sweeps.rows import BAR, Row, row_of


def uncertainties(scene: Scene, result: Result) -> dict[str, Uncertainty]:
    """Return the uncertainty of each quantity with derivatives; empty without tolerances.

    Args:
        scene: That was solved.
        result: With its derivatives and error bars.
    """
    if not scene.tolerances:
        return {}
    bars = row_of(result)
    return {
        name: _uncertainty(slopes, scene.tolerances, _bar(bars, name))
        for name, slopes in result.derivatives.items()
    }


def _uncertainty(
    slopes: Mapping[str, Derivative], tolerances: Mapping[str, float], numerical: float | None
) -> Uncertainty:
    by = {key: _part(slopes[key], size) for key, size in tolerances.items()}
    parts = [part for part in by.values() if part is not None]
    is_known = len(parts) == len(by)
    data = math.hypot(*parts) if is_known else None
    comparable = data is not None and numerical is not None
    return Uncertainty(
        data=data,
        data_at_most=sum(parts) if is_known else None,
        by=by,
        numerical=numerical,
        larger=None if not comparable else "data" if data >= numerical else "mesh",  # type: ignore[operator]
    )


def _part(slope: Derivative, tolerance: float) -> float | None:
    """Return the part of a tolerance, by the mean derivative or, without one, the discrete one."""
    found = slope.discrete if slope.value is None else slope.value
    return None if found is None else abs(found) * tolerance


def _bar(bars: Row, name: str) -> float | None:
    """Error bar of a quantity; of a component, that of its vector."""
    vector = name[:-2] if name[-2:] in ("_x", "_y", "_z") else name
    return bars.get(f"{name}{BAR}", bars.get(f"{vector}{BAR}"))
