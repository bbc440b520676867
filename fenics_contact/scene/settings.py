"""How the answer of a scene is computed: load steps, solver, accuracy."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Iterator, Mapping
from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, Strict

from fenics_contact.quantities.names import (
    CONTACT_AREA,
    MAX_CONTACT_PRESSURE,
    NORMAL_FORCE,
    STICK_AREA,
)
from fenics_contact.scene.quantity_names import looks_like_quantity
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
        Literal["auto", "campos", "lagged", "monolithic", "exact"],
        Field(
            description="of Coulomb friction: `campos` alternates friction and contact (the "
            "paper's), `lagged` solves both with the bound of the last pass, `monolithic` at "
            "once; `auto` moves on from one to the next where it does not converge; `exact` solves "
            "all contacts without penalty and friction without smoothing"
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
    slip_limit: Annotated[
        Literal["auto", "steps"],
        Field(
            description="how the factor of varying loads at which a part slips is found: "
            "`auto` by the pressures of the answer, if larger loads leave these as they are, else "
            "an upper bound, and not where `errors` is `none`; `steps` else by larger and larger "
            "loads"
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
    exact_check: Annotated[
        Literal["auto"] | Annotated[bool, Strict()],
        Field(
            description="whether the last load step is solved once more without penalty and "
            "smoothing, which measures what these change: `bias` of the results; `auto` where that "
            "takes little"
        ),
    ] = "auto"
    all_answers: Annotated[
        bool,
        Strict(),
        Field(
            description="of contacts that are solved exactly, whether all answers of the last load "
            "step are looked for: by the statuses of up to 24 points that may touch, of more from "
            "several starts; `branches` of the results"
        ),
    ] = False


Share = Annotated[Number, Field(gt=0, lt=1)]
_Asked = Share | None
# Of a scene that says but one number; in each, those that it has.
MAIN = (NORMAL_FORCE, MAX_CONTACT_PRESSURE, CONTACT_AREA, STICK_AREA)


@scene_class
class Accuracy:
    """Estimated errors that the answer may have, relative; `accuracy = 1e-3` asks for all main.

    >>> Accuracy(main=1e-2, normal_force=1e-4).asked(["normal_force", "contact_area"])
    {'normal_force': 0.0001, 'contact_area': 0.01}
    >>> Accuracy(of={"left.reaction_x": 1e-2}).asked([])
    {'left.reaction_x': 0.01}
    """

    main: Annotated[
        _Asked,
        Field(
            description="of `normal_force`, `max_contact_pressure`, `contact_area` and, with "
            "friction whose bound is not given, `stick_area`"
        ),
    ] = None
    normal_force: Annotated[
        _Asked, Field(description="over itself; where it is not known, that of `pressure_integral`")
    ] = None
    pressure_integral: Annotated[_Asked, Field(description="over itself")] = None
    friction_force: Annotated[_Asked, Field(description="over the normal force")] = None
    contact_force: Annotated[_Asked, Field(description="over itself")] = None
    reaction: Annotated[_Asked, Field(description="of all supports together, over itself")] = None
    max_contact_pressure: Annotated[_Asked, Field(description="over itself")] = None
    contact_area: Annotated[_Asked, Field(description="over itself")] = None
    stick_area: Annotated[_Asked, Field(description="over the area in contact")] = None
    slip_area: Annotated[_Asked, Field(description="over the area in contact")] = None
    contact_radius: Annotated[_Asked, Field(description="over itself")] = None
    stick_radius: Annotated[_Asked, Field(description="over the contact radius")] = None
    max_slip: Annotated[_Asked, Field(description="over itself")] = None
    indentation: Annotated[_Asked, Field(description="over itself")] = None
    strain_energy: Annotated[_Asked, Field(description="over itself")] = None
    external_work: Annotated[_Asked, Field(description="over itself")] = None
    friction_work: Annotated[_Asked, Field(description="over the strain energy")] = None
    of: Annotated[
        Mapping[str, Share],
        Field(
            description="of further quantities by their names: `NAME.quantity` of the contact or "
            "the supports called NAME (`left.reaction`), `displacement_NAME` of a `[[point]]`, "
            "and components (`left.reaction_x`), over the length of the vector. In a file these "
            'may stand beside the other keys, in quotes (`"left.reaction" = 1e-2`) or without'
        ),
    ] = Field(default_factory=dict)
    max_levels: Annotated[
        Integer, Field(ge=1, le=50, description="meshes at the most, with the first")
    ] = 10
    max_dofs: Annotated[Integer, Field(ge=100, description="of a mesh at the most")] = 200_000

    def __post_init__(self) -> None:
        for name in self.of:
            if name in QUANTITIES:
                raise ValueError(f"'{name}' is a key of its own, beside of")
        if not any(getattr(self, name) for name in QUANTITIES) and not (self.main or self.of):
            raise ValueError(
                f"ask for that of main or of any of {', '.join(QUANTITIES)}, or of a quantity by "
                "its name, such as 'left.reaction'"
            )

    def asked(self, present: Collection[str]) -> dict[str, float]:
        """Quantities asked for by their names, each with the relative error that it may have.

        Args:
            present: Quantities that the scene has; others are left out of those of ``main``.
        """
        asked = {name: getattr(self, name) for name in QUANTITIES}
        if self.main is not None:
            asked |= {name: asked[name] or self.main for name in MAIN if name in present}
        return {name: limit for name, limit in asked.items() if limit is not None} | dict(self.of)


QUANTITIES = tuple(
    field.name
    for field in dataclasses.fields(Accuracy)
    if field.name not in ("main", "of", "max_levels", "max_dofs")
)


def as_accuracy(value: Any) -> Any:
    """A number asks for that of all main quantities; quantities by their names go to ``of``."""
    if _is_number(value):
        return {"main": float(value)}
    if value is None or isinstance(value, Accuracy):
        return value
    if not isinstance(value, Mapping):
        raise ValueError("must be a number, as in accuracy = 1e-3, or a table")
    keys = {key: part for key, part in value.items() if not _is_name(key, part)}
    beside = {key: part for key, part in value.items() if key not in keys and key != "of"}
    further = value.get("of", {})
    if not isinstance(further, Mapping):
        return value  # refused for its type
    named = [*flat_names(beside), *flat_names(further)]
    for number, (name, share) in enumerate(named):
        if any(name == other for other, _ in named[:number]):
            raise ValueError(f"'{name}' is given twice")
        if not _is_number(share) or not 0 < share < 1:
            raise ValueError(f"'{name}' = {share!r}: must be a number greater than 0, less than 1")
    return keys | {"of": {name: float(share) for name, share in named}}


def _is_number(value: object) -> bool:
    return isinstance(value, float | int) and not isinstance(value, bool)


def _is_name(key: str, value: object) -> bool:
    """Whether a key is, or a table begins, the name of a quantity that has no key of its own."""
    return isinstance(value, Mapping) or (looks_like_quantity(key) and key not in QUANTITIES)


def flat_names(table: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    """Names and values: dotted keys, which make tables in tables, mean the same as in quotes.

    Raises:
        ValueError: A table is empty.
    """
    if before and not table:
        raise ValueError(f"'{before[:-1]}' is an empty table")
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from flat_names(value, f"{before}{key}.")
        else:
            yield before + key, value
