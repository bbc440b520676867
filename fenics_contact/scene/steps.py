"""The part of a scene that says how it is solved: load steps, strategy, solver."""

from __future__ import annotations

from functools import cached_property
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, Strict

from fenics_contact.scene.values import Integer, Number, Positive, scene_class


@scene_class
class Steps:
    """Load steps: friction remembers how a load was reached.

    >>> Steps(number=4, end=2).all_times
    (0.5, 1.0, 1.5, 2.0)
    >>> Steps(automatic=True, number=10).smallest_size
    0.0001
    """

    number: Annotated[
        Integer, Field(ge=1, le=100_000, description="of equal steps in pseudo-time")
    ] = 1
    end: Annotated[Positive, Field(description="pseudo-time of the last step")] = 1.0
    times: Annotated[
        tuple[Positive, ...],
        Field(description="instead of the two: pseudo-time of each step, increasing"),
    ] = ()
    automatic: Annotated[
        bool,
        Strict(),
        Field(
            description="whether steps are cut where they do not converge or the contact changes "
            "too much, and grow again: number is then that of the first step's size, end/number; "
            "none passes over an entry of a path's table"
        ),
    ] = False
    smallest: Annotated[
        Positive | None,
        Field(description="automatic step (pseudo-time); by default a thousandth of the first"),
    ] = None
    largest: Annotated[
        Positive | None,
        Field(description="automatic step (pseudo-time); by default the first"),
    ] = None
    area_change: Annotated[
        Number,
        Field(
            gt=0,
            description="largest change of what touches, or of what sticks, in an automatic step, "
            "over the area in contact; one that does not shrink with the step is a jump, and taken",
        ),
    ] = 0.2

    def __post_init__(self) -> None:
        if any(b <= a for a, b in zip(self.times, self.times[1:], strict=False)):
            raise ValueError("the times must increase")
        if self.automatic and self.times:
            raise ValueError("automatic: leave out times, automatic steps choose their own")
        limits = [name for name in ("smallest", "largest") if getattr(self, name) is not None]
        if limits and not self.automatic:
            raise ValueError(f"{limits[0]}: only automatic steps have one; set automatic = true")
        if self.smallest_size > self.largest_size:
            raise ValueError(
                f"smallest = {self.smallest_size:g} exceeds largest = {self.largest_size:g}, "
                "which is the first step where it is not given"
            )

    @property
    def first_size(self) -> float:
        """The first automatic step (pseudo-time)."""
        return min(self.end / self.number, self.largest or np.inf)

    @property
    def smallest_size(self) -> float:
        """No automatic step is cut below this (pseudo-time)."""
        return self.smallest or 1e-3 * self.first_size

    @property
    def largest_size(self) -> float:
        """No automatic step grows beyond this (pseudo-time)."""
        return self.largest or self.first_size

    @property
    def last(self) -> float:
        """Pseudo-time at which they end."""
        return self.all_times[-1]

    @property
    def several(self) -> bool:
        """Whether there may be more than one."""
        return self.automatic or len(self.all_times) > 1

    @cached_property
    def all_times(self) -> tuple[float, ...]:
        """Pseudo-time at the end of each step; of automatic ones, if none is cut."""
        if self.times:
            return self.times
        return tuple(self.end * (step + 1) / self.number for step in range(self.number))


@scene_class
class SolverSettings:
    """How friction and pressure are brought together, and when the solver stops.

    The strategy ``campos`` is Algorithm 4.1 of Campos, Oden and Kikuchi (1982).
    """

    strategy: Annotated[
        Literal["auto", "campos", "lagged", "monolithic"],
        Field(
            description="of Coulomb friction: `campos` alternates friction and contact (the "
            "paper's), `lagged` solves both with the bound of the last pass, `monolithic` at "
            "once; `auto` moves on from one to the next where it does not converge"
        ),
    ] = "auto"
    solver: Annotated[
        Literal["auto", "condensed", "full", "iterative"],
        Field(
            description="`condensed` factorises the bulk once and iterates on the contact surfaces "
            "alone, `full` on all displacements, with a factorisation in every Newton step, "
            "`iterative` by multigrid, for large 3D bodies that are not nearly incompressible; "
            "`auto` chooses by sizes and memory"
        ),
    ] = "auto"
    branches: Annotated[
        bool,
        Strict(),
        Field(
            description="whether to look for other answers of the last load step, from other "
            "starts: with a large coefficient Coulomb's friction may have several"
        ),
    ] = False
    errors: Annotated[
        Literal["auto", "all", "none"],
        Field(
            description="whether to estimate the errors of the results: `auto` what takes little, "
            "with the condensed solver all but of histories in which hardly a load step can be "
            "left out; with others errors by penalty, regularisation and iterations, without any "
            "history; `all` estimates all, and of histories by all their load steps again"
        ),
    ] = "auto"
    outer_tolerance: Annotated[
        Number,
        Field(gt=0, lt=1e-2, description="change of the pressure in a pass, over its peak"),
    ] = 1e-8
    max_outer_iterations: Annotated[
        Integer, Field(ge=1, le=10_000, description="passes of the loop on the pressure at most")
    ] = 60

    tolerance: Annotated[
        Number,
        Field(gt=0, lt=1e-3, description="force imbalance over all applied and support forces"),
    ] = 1e-10
    max_iterations: Annotated[
        Integer, Field(ge=1, le=1_000_000, description="Newton steps at the most")
    ] = 100
    stabilisation: Annotated[
        bool,
        Strict(),
        Field(
            description="whether motions of a body that nothing resists and no load pushes, such "
            "as the spin of a smooth sphere, are held, at as few displacements as determine them; "
            "the force there must vanish, which the check `stabilisation` confirms"
        ),
    ] = False
