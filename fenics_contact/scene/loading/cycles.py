"""The part of a scene that says that loads come again: the same cycle, many times."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from fenics_contact.analyses.wear_cycles.table import CycleJump
from fenics_contact.scene.core_scene import LoadCycles
from fenics_contact.scene.given_keys import FREE_AT_RESUME
from fenics_contact.scene.values import Integer, Number, Positive, scene_class


@scene_class
class Cycles(LoadCycles):
    """A piece of all load paths that runs again and again, until the answer does so, too.

    Between ``begin`` and ``end`` all paths together are one cycle; it is 4 long here, and comes 50
    times at the most:

    >>> cycles = Cycles(begin=1, end=5, number=50, increments=16)
    >>> cycles.repetition.period, cycles.repetition.ends[-1]
    (4.0, 201.0)
    """

    end: Annotated[Positive, Field(description="pseudo-time at which the first cycle ends")]
    begin: Annotated[
        Number, Field(ge=0, description="pseudo-time at which it begins; what comes before is once")
    ] = 0.0
    number: Annotated[
        Integer,
        FREE_AT_RESUME,
        Field(ge=1, le=100_000, description="of cycles; with `until` at the most"),
    ] = 20
    increments: Annotated[
        Annotated[Integer, Field(ge=1, le=10_000)] | None,
        FREE_AT_RESUME,
        Field(
            description="load steps of a cycle, spread over it so that every turn of a path is the "
            "end of one; by default those of `[steps]` between begin and end"
        ),
    ] = None
    until: Annotated[
        Literal["closed", "end"],
        FREE_AT_RESUME,
        Field(
            description="`closed`: no cycle is computed again once the loop is closed; `end`: all "
            "are computed"
        ),
    ] = "closed"
    tolerance: Annotated[
        Number,
        FREE_AT_RESUME,
        Field(
            gt=0,
            lt=1,
            description="a loop is closed where tractions at the end of a cycle, and what it "
            "loses, differ from those of the cycle before by less than this share",
        ),
    ] = 1e-3
    keep: Annotated[
        Literal["steps", "cycles"],
        FREE_AT_RESUME,
        Field(description="fields are written of load `steps`, or of the ends of `cycles` only"),
    ] = "steps"
    jumps: Annotated[
        CycleJump | None,
        Field(
            description="where a contact wears: how far cycles may be passed over, `{}` for what "
            "is usual; by default none is"
        ),
    ] = None

    def __post_init__(self) -> None:
        if self.begin >= self.end:
            raise ValueError(f"begin = {self.begin:g} must be less than end = {self.end:g}")
