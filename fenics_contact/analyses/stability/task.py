"""Steady sliding in a run: its complex modes over the friction coefficient, and their files."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fenics_contact.analyses.stability.record import (
    ComplexModeRecord,
    ModesAtCoefficient,
    StabilityRecord,
)
from fenics_contact.analyses.stability.sliding_modes import (
    GROWS,
    ComplexMode,
    first_growth,
    sliding_modes,
)
from fenics_contact.analyses.stability.table import Stability
from fenics_contact.analyses.stability.words import stability_words
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import in_3d
from fenics_contact.common.errors import InputError, NotConvergedError
from fenics_contact.common.parallel import on_root
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.results.result import Result
from fenics_contact.scene.loading.motion import Rayleigh
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.analysis_tasks import AnalysisTask
from fenics_contact.simulation.output.fields import body_of_cells, write_collection, write_grid
from fenics_contact.simulation.studies.kept_body import KeptBody


class StabilityTask(AnalysisTask):
    """Finds the modes of bodies that slide.

    Attributes:
        found: Modes with their shapes; None before these are found.
    """

    missing = "No stability"
    fields = "Fields of complex modes were not written"
    found: SlidingStability | None = None

    def complete(self, result: Result, body: Callable[[], KeptBody], notes: list[str]) -> Result:
        """The result with the modes, and with what they tell in words."""
        found = self.found = stability_of(body(), self.scene)
        said = [result.verdict, stability_words(found.record, result.units), *found.notes]
        return replace(result, stability=found.record, verdict=" ".join(said))

    def write_fields(self, problem: Problem, result: Result, folder: Path) -> None:
        """Write ``squeal.pvd``."""
        if self.found is not None:
            write_complex_modes(problem.spaces, self.found.shapes, folder)


TASK = StabilityTask


logger = logging.getLogger(__name__)

# To which the critical coefficient is found, over that up to which it is searched.
_SEARCH = 1e-4


@dataclass(frozen=True, eq=False)
class SlidingStability:
    """Results on the stability of steady sliding.

    Attributes:
        record: As ``result.json`` has it.
        shapes: Of the modes at the scene's own coefficient.
        notes: Sentences on what was not to be had.
    """

    record: StabilityRecord
    shapes: Sequence[ComplexMode]
    notes: Sequence[str] = ()


def stability_of(kept: KeptBody, scene: Scene) -> SlidingStability:
    """Solve a scene, find the complex modes of its sliding, and those of other coefficients.

    For each coefficient the state is solved anew; collective.

    Args:
        kept: Its body.
        scene: One that asks for stability.

    Raises:
        InputError: It asks for more modes than there are; or it has no equilibrium.
        NotConvergedError: There is no state of sliding, or its modes were not found.
    """
    asked = scene.stability
    if asked is None:
        raise InputError("stability: the scene does not ask for it; say so by [stability]")
    own = _largest_coefficient(scene)
    shapes = _modes(kept, scene, asked)
    at: dict[float, ModesAtCoefficient] = {own: _at_coefficient(own, shapes)}

    def found(coefficient: float) -> ModesAtCoefficient:
        if coefficient not in at:
            changed = with_coefficient(scene, coefficient)
            at[coefficient] = _at_coefficient(coefficient, _modes(kept, changed, asked))
        return at[coefficient]

    curve, notes = _curve(found, asked)
    critical = None
    if curve:
        critical = first_growth(
            lambda coefficient: found(coefficient).largest_growth_rate > 0,
            [one.friction_coefficient for one in curve],
            _SEARCH * curve[-1].friction_coefficient,
        )
    record = StabilityRecord(
        friction_coefficient=own,
        modes=_records(shapes),
        critical_coefficient=critical,
        curve=curve,
    )
    return SlidingStability(record, shapes, notes)


def with_coefficient(scene: Scene, coefficient: float) -> Scene:
    """A scene whose largest friction coefficient is another one, the others in proportion.

    It asks for no stability itself, which one without friction could not.
    """
    factor = coefficient / _largest_coefficient(scene)
    contacts = tuple(
        replace(contact, friction_coefficient=factor * _number(contact.friction_coefficient))
        if contact.is_rough
        else contact
        for contact in scene.contact
    )
    return replace(scene, contact=contacts, stability=None)


def _number(value: object) -> float:
    assert isinstance(value, float | int)  # which the scene has seen to
    return float(value)


def _largest_coefficient(scene: Scene) -> float:
    return max(_number(one.friction_coefficient) for one in scene.contact if one.is_rough)


def _curve(
    found: Callable[[float], ModesAtCoefficient], asked: Stability
) -> tuple[list[ModesAtCoefficient], list[str]]:
    """Modes at all coefficients, up to the first one without a state of sliding."""
    curve: list[ModesAtCoefficient] = []
    for coefficient in asked.coefficients:
        try:
            curve.append(found(coefficient))
        except (InputError, NotConvergedError) as error:
            said = str(error).removeprefix("stability: ")
            note = f"Modes are not followed beyond a coefficient of {coefficient:g}: {said}."
            logger.warning("%s", note)
            return curve, [note]
        logger.info(
            "  friction coefficient %g: largest growth rate %.3g",
            coefficient,
            curve[-1].largest_growth_rate,
        )
    return curve, []


def _modes(kept: KeptBody, scene: Scene, asked: Stability) -> list[ComplexMode]:
    """Return the stability of a scene's last state; collective."""
    timings, rayleigh = Timings(), asked.rayleigh or Rayleigh()
    with kept.stepping(scene, timings) as (load_steps, system):
        load_steps.solve()
        damping = float(rayleigh.mass), float(rayleigh.stiffness)
        return sliding_modes(system, system.body, asked.number, damping)


def _grows(mode: ComplexMode) -> bool:
    return mode.exponent.real > GROWS * abs(mode.exponent)


def _at_coefficient(coefficient: float, modes: Sequence[ComplexMode]) -> ModesAtCoefficient:
    exponents = np.array([mode.exponent for mode in modes])
    growing = [mode.exponent.real for mode in modes if _grows(mode)]
    return ModesAtCoefficient(
        friction_coefficient=coefficient,
        frequencies=(exponents.imag / (2 * math.pi)).tolist(),
        growth_rates=exponents.real.tolist(),
        largest_growth_rate=max(growing, default=0.0),
    )


def _records(modes: Sequence[ComplexMode]) -> list[ComplexModeRecord]:
    return [
        ComplexModeRecord(
            number=number,
            frequency=mode.exponent.imag / (2 * math.pi),
            growth_rate=mode.exponent.real,
            damping_ratio=0.0 - mode.exponent.real / abs(mode.exponent),
            grows=_grows(mode),
        )
        for number, mode in enumerate(modes, start=1)
    ]


def write_complex_modes(spaces: Spaces, modes: Sequence[ComplexMode], folder: Path) -> None:
    """Write ``squeal.pvd``: a grid a mode, in place of a time its number; collective.

    Its displacement, and what that is a quarter of a period later, without its growth.

    Args:
        spaces: Of the body.
        modes: In their order.
        folder: Where to.
    """
    grids: dict[str, float] = {}
    space, bodies = spaces.displacement_space, body_of_cells(spaces)
    for number, mode in enumerate(modes, start=1):
        fields = {
            "displacement": in_3d(mode.shape.real),
            "displacement_quarter_later": in_3d(-mode.shape.imag),
        }
        grids[write_grid(folder, "squeal", number, space, fields, bodies)] = float(number)
    on_root(spaces.comm, lambda: write_collection(folder / "squeal.pvd", grids))
