"""Result of a fit: the content of ``fit.json``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from fenics_contact.results.records.record import Record, UnitsRecord

#: The files of a fit in its folder: the record, both curves, and the page.
RECORD, CURVE, PAGE = "fit.json", "fit.csv", "fit.html"


@dataclass(frozen=True, eq=False, kw_only=True)
class FittedParameter(Record):
    """A number of the scene that was found.

    Attributes:
        value: For which the run meets the data best.
        low: Lower end of its interval; null where the data do not determine it.
        high: Upper end, likewise.
        start: Where the search began.
        noise: Half the width of the interval by the noise of the data alone; null as above.
        discretisation: How far mesh, penalty and regularisation may shift it; null as above, or
            where they were not estimated.
        at_bound: Whether a bound holds it, so that the data would have it beyond.
    """

    value: float
    low: float | None
    high: float | None
    start: float
    noise: float | None
    discretisation: float | None
    at_bound: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class FitRecord(Record):
    """A fit of a run's curve to a measured one.

    Attributes:
        parameters: Key of the scene → what was found.
        confidence: That an interval covers the truth, if the model is right.
        residual: Root mean square of the run less the data, in the quantity's unit.
        evaluations: How often the curve was solved for.
        converged: Whether the search came to its end.
        verdict: What came out, in a few sentences.
        quantity: That was measured.
        over: `time`, a quantity or keys of the scene.
        rows: Of the data.
        misfit: Σ (residual / uncertainty)² over the degrees of freedom, about 1 if run and data
            agree; null where no uncertainties were given.
        correlations: Of the estimates by the noise, a row a parameter.
        singular_values: Of the derivatives, each parameter's of length 1: a small one is a
            combination of parameters that the data hardly tell.
        notes: What to know of the intervals, in sentences.
        checks: Checks of the physics that failed in the run of the values found.
        title: Of the scene.
        scene: Its file as it was given.
        measured: The data's file.
        units: Of all numbers, if the scene has some.
    """

    parameters: Mapping[str, FittedParameter]
    confidence: float
    residual: float
    evaluations: int
    converged: bool
    verdict: str
    quantity: str
    over: list[str]
    rows: int
    misfit: float | None
    correlations: list[list[float]]
    singular_values: list[float]
    notes: list[str]
    checks: list[str]
    title: str = ""
    scene: str = ""
    measured: str = ""
    units: UnitsRecord | None = None

    @property
    def exit_code(self) -> int:
        """0, 3 where the search did not converge, 4 where a check failed."""
        if not self.converged:
            return 3
        return 4 if self.checks else 0
