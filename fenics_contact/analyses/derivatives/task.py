"""Derivatives in a run: of its answer by the adjoint, and the uncertainty by tolerances."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

from fenics_contact.analyses.derivatives.means import Mean, Means
from fenics_contact.analyses.derivatives.record import Derivative, Derivatives, Uncertainty
from fenics_contact.common.errors import InputError
from fenics_contact.common.failures import attempt
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities import table
from fenics_contact.results.result import Result
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.analysis_tasks import AnalysisTask
from fenics_contact.simulation.sensitivities.derivatives import keys_of
from fenics_contact.simulation.sensitivities.gradients import find
from fenics_contact.simulation.sensitivities.scene_values import found_in
from fenics_contact.simulation.studies.kept_body import KeptBody
from fenics_contact.simulation.studies.solved_derivatives import solved_derivatives
from fenics_contact.simulation.sweeps.rows import BAR, Row, row_of


class DerivativeTask(AnalysisTask):
    """Finds derivatives, and what tolerances make of them."""

    missing = "No derivatives"

    def require(self, problem: Problem) -> None:
        """Refuse quantities and numbers that have no derivative."""
        self._keys = keys_asked_of(problem)

    def complete(self, result: Result, body: Callable[[], KeptBody], notes: list[str]) -> Result:
        """The result with derivatives and uncertainties."""
        kept = body()
        found = asked_derivatives(kept, self.scene, self._keys)
        result = replace(result, derivatives=found)
        tell, missing = partial(uncertainties, self.scene, result), "No uncertainties"
        comm = kept.discrete.spaces.comm
        return replace(result, uncertainty=attempt(comm, missing, tell, result.uncertainty, notes))

    def unknown(self, result: Result) -> Result:
        """The result with derivatives that nobody knows."""
        asked = self.scene.derivatives
        assert asked is not None
        nothing = Derivative(value=None, spread=None, discrete=None, one_sided=False)
        unknown = {name: dict.fromkeys(self._keys, nothing) for name in asked.of}
        return replace(result, derivatives=unknown)


TASK = DerivativeTask


# Of a derivative: a spread of single answers that tells of jumps, however narrow their window is.
_TELLS = 0.1


def keys_asked_of(problem: Problem) -> list[str]:
    """Keys of the numbers in which a scene asks for derivatives; collective.

    Those that it names, or all that there are, and those with tolerances.

    Args:
        problem: Of a scene that asks for derivatives.

    Raises:
        InputError: A quantity or a key that is named has none.
    """
    scene, time = problem.scene, problem.scene.load_steps.last
    asked = scene.derivatives
    assert asked is not None
    try:
        for name in _with_exact(scene):
            find(problem, name)
        keys = keys_of(problem, time, asked.by)
    except InputError as error:
        raise InputError(f"derivatives.{error}") from None
    try:
        tolerated = keys_of(problem, time, list(scene.tolerances))
    except InputError as error:
        raise InputError(f"tolerances: {str(error).removeprefix('by: ')}") from None
    return list(dict.fromkeys([*keys, *tolerated]))


def _with_exact(scene: Scene) -> list[str]:
    """Quantities asked for whose discrete answer has a derivative."""
    asked = scene.derivatives
    assert asked is not None
    return [name for name in asked.of if not table.edges_of(scene.names.find(name).quantity)]


def asked_derivatives(kept: KeptBody, scene: Scene, keys: Sequence[str]) -> Derivatives:
    """Derivatives of the answer of a scene, as it asks for them; collective.

    Args:
        kept: Its body.
        scene: A scene that asks for derivatives.
        keys: As of ``keys_asked_of``.

    Raises:
        InputError: A quantity has none.
        NotConvergedError: There is no answer.
    """
    asked = scene.derivatives
    assert asked is not None
    try:
        exact = solved_derivatives(kept, scene, _with_exact(scene), keys)
    except InputError as error:
        raise InputError(f"derivatives.{error}") from None
    means = Means(kept, scene, list(asked.of), keys, exact)
    found: Derivatives = {name: {} for name in asked.of}
    for key in keys:
        mean, number = means.by(key), float(found_in(scene, key))
        for name in asked.of:
            one = mean.get(name), exact.slopes.get(name, {}).get(key)
            size = means.quantity(name)
            found[name][key] = _derivative(*one, number / size if size else 0.0, exact.one_sided)
    return found


def _derivative(
    mean: Mean | None, discrete: float | None, ratio: float, one_sided: bool
) -> Derivative:
    """With a spread that reaches the exact one, too.

    Args:
        mean: And its spread.
        discrete: The exact one.
        ratio: Of the number to the quantity, 0 where there is none.
        one_sided: Whether the answer has a kink.
    """
    value = spread = None
    if mean is not None:
        value = mean.value
        spread = max(mean.spread, 0.0 if discrete is None else abs(discrete - mean.value))
        # In a window narrower than a cell a small one says nothing: jumps may lie beside it.
        if mean.of_single_answers and spread <= _TELLS * abs(mean.value):
            spread = None
    best = discrete if value is None else value
    return Derivative(
        value=value,
        spread=spread,
        discrete=discrete,
        normalised=None if best is None or not ratio else best * ratio,
        one_sided=one_sided,
        of_single_answers=mean is not None and mean.of_single_answers,
    )


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
