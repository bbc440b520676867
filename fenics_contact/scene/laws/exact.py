"""Conditions for scenes whose contacts are solved without penalty and smoothing of friction."""

from __future__ import annotations

from fenics_contact.analyses import registry
from fenics_contact.scene.core_scene import CoreScene


def require_exact(scene: CoreScene) -> None:
    """Refuse what does not go together with contacts that are solved exactly.

    Args:
        scene: Any; one that asks for no such contact passes.

    Raises:
        ValueError: In a sentence that begins with the key.
    """
    if not scene.is_exact:
        if scene.solver.all_answers:
            raise ValueError(
                "solver.all_answers = true: all answers are found where contacts are solved "
                "exactly; set solver.strategy = 'exact', or take solver.branches = true"
            )
        return
    _require_parameters(scene)
    solver = scene.solver
    if solver.solver not in ("auto", "condensed"):
        raise ValueError(
            f"solver.solver = '{solver.solver}': contacts are solved exactly by 'condensed' alone; "
            "take that one or 'auto', or give no parameter 0"
        )
    others: dict[str, object] = {
        "motion": scene.motion,
        "heat": scene.heat,
        "cyclic_symmetry": scene.cyclic_symmetry,
        **dict.fromkeys(registry.tables_not_with(scene, "exact contacts"), True),
    }
    for key, given in others.items():
        if given:
            raise ValueError(
                f"{key}: beside it contacts are not solved exactly; give no parameter 0 and "
                'another strategy than "exact"'
            )


def _require_parameters(scene: CoreScene) -> None:
    """Refuse parameters > 0 with the strategy `exact`, and parameters = 0 with other strategies."""
    strategy = scene.solver.strategy
    for number, contact in enumerate(scene.contact):
        for key in ("penalty_parameter", "regularisation_parameter"):
            value = getattr(contact, key)
            if strategy == "exact" and value not in ("auto", 0):
                raise ValueError(
                    f"contact[{number}].{key} = {value:g}: solver.strategy = 'exact' takes 0; "
                    "leave it out, or take another strategy"
                )
            if strategy not in ("auto", "exact") and value == 0:
                raise ValueError(
                    f"contact[{number}].{key} = 0: only solver.strategy = 'exact' or 'auto' can "
                    f"have that, not '{strategy}'"
                )
