"""How far cycles that wear may be passed over: a table of its own in a scene, ``cycles.jumps``."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from fenics_contact.analyses import registry
from fenics_contact.scene.core_scene import CoreScene
from fenics_contact.scene.given_keys import FREE_AT_RESUME
from fenics_contact.scene.settings import Steps
from fenics_contact.scene.values import Integer, Number, scene_class

#: Why none of its load steps can be taken by those who take one after the other.
ONE_BY_ONE = (
    "cycles.jumps: here each load step is computed; cycles are passed over by `run`, "
    "`Study.solve` and `Study.worn`"
)


@scene_class
class CycleJump:
    """How far cycles that wear are passed over, by what those that are computed wear.

    >>> CycleJump().pressure_change, CycleJump(error=0.001).error
    (0.2, 0.001)
    """

    pressure_change: Annotated[
        Number,
        FREE_AT_RESUME,
        Field(gt=0, description="largest change of a pressure in a jump, over the largest one"),
    ] = 0.2
    error: Annotated[
        Number,
        FREE_AT_RESUME,
        Field(
            gt=0,
            description="about the largest estimated error of all jumps in the end: of the depths "
            "over the deepest, and of the worn volume over itself",
        ),
    ] = 0.01
    fixed: Annotated[
        Annotated[Integer, Field(ge=1)] | None,
        FREE_AT_RESUME,
        Field(
            description="how many cycles further on every next one is that is computed, in place "
            "of the control; by default there is control"
        ),
    ] = None


def require(scene: CoreScene) -> None:
    """Refuse a scene whose cycles cannot be passed over.

    Raises:
        ValueError: In words.
    """
    assert scene.cycles is not None
    if not any(contact.wear for contact in scene.contact):
        raise ValueError(
            "cycles.jumps: no contact wears, so that nothing grows from cycle to cycle; leave it "
            "out: cycles that repeat are not computed again"
        )
    if scene.steps.automatic:
        raise ValueError("cycles.jumps: every cycle has the same load steps; set automatic = false")
    if scene.cycles.begin == 0:
        raise ValueError(
            "cycles.jumps: begin = 0; the first cycle must begin at the end of a load step, with "
            "which the loads have grown"
        )
    others = {
        "accuracy": scene.accuracy is not None,
        **dict.fromkeys(registry.tables_not_with(scene, "own steps"), True),
        "solver.branches": scene.solver.branches,
        f"solver.solver = '{scene.solver.solver}'": scene.solver.solver in ("full", "iterative"),
    }
    for key, is_said in others.items():
        if is_said:
            raise ValueError(
                f"{key}: cycles are passed over on one condensed body, without this; leave it out"
            )


def load_steps(scene: CoreScene) -> Steps:
    """Load steps of a run, of which each is the end of a cycle."""
    assert scene.cycles is not None
    return Steps(times=scene.cycles.repetition.ends)
