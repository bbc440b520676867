"""The derivatives that a scene asks for, of its answer on a kept body."""

from __future__ import annotations

from fenics_contact.common.errors import InputError
from fenics_contact.problem.problem import Problem
from fenics_contact.results.records.derivatives import Derivative, Derivatives
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.asked_derivatives.means import Mean, Means
from fenics_contact.simulation.sensitivities.derivatives import keys_of
from fenics_contact.simulation.sensitivities.state_gradients import Quantities
from fenics_contact.simulation.studies.kept_body import KeptBody
from fenics_contact.simulation.studies.solved_derivatives import solved_derivatives

# From cell to cell these are no smooth function of anything: only their means have a meaning.
_MEANS_ALONE = ("contact_area", "stick_area", "slip_area", "contact_radius", "stick_radius")


def require_known(problem: Problem) -> None:
    """Refuse quantities and keys that have no derivative before anything is solved; collective.

    Args:
        problem: Of a scene that asks for derivatives.

    Raises:
        InputError: One that is named has none.
    """
    asked = problem.scene.derivatives
    assert asked is not None
    try:
        for name in _with_exact(problem.scene):
            Quantities(problem).find(name)
        keys_of(problem, problem.scene.steps.last, asked.by)
    except InputError as error:
        raise InputError(f"derivatives.{error}") from None


def _with_exact(scene: Scene) -> list[str]:
    """Quantities asked for whose discrete answer has a derivative."""
    asked = scene.derivatives
    assert asked is not None
    return [name for name in asked.of if scene.names.find(name).quantity not in _MEANS_ALONE]


def asked_derivatives(kept: KeptBody, scene: Scene) -> Derivatives:
    """Derivatives of the answer of a scene, as it asks for them; collective.

    Args:
        kept: Its body.
        scene: A scene that asks for derivatives.

    Raises:
        InputError: A quantity or a key has none.
        NotConvergedError: There is no answer.
    """
    asked = scene.derivatives
    assert asked is not None
    of = _with_exact(scene) or ["strain_energy"]  # of which the keys are
    try:
        exact = solved_derivatives(kept, scene, of, asked.by)
    except InputError as error:
        raise InputError(f"derivatives.{error}") from None
    means = Means(kept, scene, list(asked.of), exact)
    found: Derivatives = {name: {} for name in asked.of}
    for key in exact.slopes[of[0]]:
        mean = means.by(key)
        for name in asked.of:
            discrete = exact.slopes.get(name, {}).get(key)
            found[name][key] = _derivative(mean.get(name), discrete, exact.one_sided)
    return found


def _derivative(mean: Mean | None, discrete: float | None, one_sided: bool) -> Derivative:
    """With a spread that reaches the exact one, too."""
    value = spread = None
    if mean is not None:
        value, spread = mean
        spread = spread if discrete is None else max(spread, abs(discrete - value))
    return Derivative(value=value, spread=spread, discrete=discrete, one_sided=one_sided)
