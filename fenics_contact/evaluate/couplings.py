"""How coupled faces move in an answer, and what moves them."""

from __future__ import annotations

from collections.abc import Sequence

from fenics_contact.problem.loads.couplings import PointMotion
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.scalar_unknown import ScalarState
from fenics_contact.results.records.contacts import CouplingRecord, SupportRecord
from fenics_contact.solve.systems.solution import Solution


def coupling_motions(
    problem: Problem, scalars: Sequence[ScalarState]
) -> list[dict[str, list[float]]]:
    """Displacement and rotation of each coupling in an answer.

    Args:
        problem: The model.
        scalars: States of the body's scalars in the answer.
    """
    found: list[dict[str, list[float]]] = [
        {"displacement": [], "rotation": []} for _ in problem.couplings
    ]
    numbers = {one.label: number for number, one in enumerate(problem.scene.coupling)}
    for one, state in zip(problem.body_scalars, scalars, strict=True):
        if isinstance(one, PointMotion):
            kind, _ = one.way
            found[numbers[one.scene.label]][kind].append(one.amount_of(state.value))
    if problem.spaces.kinematics == "axisymmetric":
        for motion in found:
            motion["displacement"].insert(0, 0.0)
    return found


def coupling_records(
    problem: Problem, solution: Solution, supports: Sequence[SupportRecord]
) -> list[CouplingRecord]:
    """Records of the couplings in an answer, without errors.

    Args:
        problem: The model.
        solution: The answer.
        supports: Records of what is held, of which couplings are a part.
    """
    motions = coupling_motions(problem, solution.scalars)
    held = [supports[number] for number in problem.couplings]
    return [
        CouplingRecord(
            name=coupling.label,
            on=coupling.on,
            kind=coupling.kind,
            force=list(support.reaction),
            moment=_components(support.reaction_moment),
            displacement=motion["displacement"],
            rotation=motion["rotation"],
        )
        for coupling, support, motion in zip(problem.scene.coupling, held, motions, strict=True)
    ]


def _components(moment: float | list[float] | None) -> list[float]:
    """Components of a moment: one in the plane, none where there are no moments."""
    if moment is None:
        return []
    return list(moment) if isinstance(moment, list) else [moment]
