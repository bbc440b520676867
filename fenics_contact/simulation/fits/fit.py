"""Least squares of a run's curve against a measured one."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from scipy import optimize

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.errors import InputError, NotConvergedError
from fenics_contact.results.fit_record import FitRecord, FittedParameter
from fenics_contact.simulation.description import units_of
from fenics_contact.simulation.fits.curves import CurveAnswer, curve_of
from fenics_contact.simulation.fits.intervals import CONFIDENCE, Intervals, notes_of, verdict_of
from fenics_contact.simulation.fits.journal import FitJournal
from fenics_contact.simulation.fits.measured import (
    Given,
    Measured,
    Parameter,
    parameters_of,
    read_measured,
)
from fenics_contact.simulation.studies.study import Study

logger = logging.getLogger(__name__)

#: Evaluations of the curve at the most, besides that of the values found.
MOST = 15
# The search ends where a step lessens the sum of squares by no more than this, over that of noise
# with one degree of freedom: it has moved the estimates by a sixth of a deviation at the most, and
# the next one would move them by much less. Or where it moves them by less than this share.
_SUM, _STEP = 2e-2, 1e-4
# A parameter that moves the curve by less than this share of it, as it changes by its scale, does
# so by round-off.
_NOTHING = 1e-9
# At a bound: nearer to it than this share of a parameter's scale.
_AT_BOUND = 1e-6


@dataclass(frozen=True, eq=False)
class Fit:
    """Result of a fit, with the measured and the fitted curve.

    Attributes:
        record: The content of ``fit.json``.
        measured: The data.
        values: Of the run with the values found, at the rows of the data, (rows,).
    """

    record: FitRecord
    measured: Measured
    values: Array

    @property
    def changes(self) -> dict[str, float]:
        """The values found, by the keys of the scene."""
        return {key: one.value for key, one in self.record.parameters.items()}


def fit(
    study: Study,
    measured: Measured | Path | str,
    parameters: Given,
    of: str | None = None,
    journal: FitJournal | None = None,
) -> Fit:
    """Find the values of keys of a scene for which its run meets a measured curve; collective.

    Args:
        study: Of the scene; its own values are where the search begins.
        measured: The curve, or its CSV file: columns of ``time``, a quantity, or keys of the scene;
            of the quantity that was measured; and ``QUANTITY_error``, its standard uncertainty, if
            that is known.
        parameters: Keys, with (low, high) or None; or words ``KEY`` and ``KEY=LOW:HIGH``.
        of: Which quantity, where the file has several.
        journal: Keeps every curve that is solved for, and knows those of an interrupted fit; on one
            rank only.

    Returns:
        Values with intervals for 95 %: of the noise of the data, and of what mesh, penalty and
        regularisation may change.

    Raises:
        InputError: The data, a key or a bound cannot be used, or the scene with the values that the
            search begins at.
        NotConvergedError: The scene has no answer there.
        MachineError: As of ``Study.solve``.
    """
    if not isinstance(measured, Measured):
        measured = read_measured(Path(measured), study.scene, of)
    chosen = parameters_of(study.scene, parameters)
    _require_enough(measured, chosen)
    search = _Search(study, measured, chosen, journal)
    found = search.solve()
    return Fit(search.record(found), measured, search.best.values)


def _require_enough(measured: Measured, parameters: list[Parameter]) -> None:
    for parameter in parameters:
        if parameter.key in measured.over:
            raise InputError(
                f"--parameters {parameter.key}: {measured.source} has a column of it, so that it "
                "is known"
            )
    least = len(parameters) + (measured.uncertainties is None)
    if len(measured) < least:
        why = "" if measured.uncertainties is not None else ", as the noise is to be told from them"
        raise InputError(
            f"{measured.source}: it has {len(measured)} rows; to find {len(parameters)} parameters "
            f"at least {least} are needed{why}"
        )


class _Search:
    """From the values that a scene has to those of the best curve.

    Attributes:
        evaluations: How often the curve was asked for, of the solver or the journal.
        best: The curve of the values found, once they are.
    """

    def __init__(
        self,
        study: Study,
        measured: Measured,
        parameters: list[Parameter],
        journal: FitJournal | None,
    ) -> None:
        self._study, self._measured, self._parameters = study, measured, parameters
        self._journal = journal
        self._curve = curve_of(measured, study)
        self._scales = np.array([parameter.scale for parameter in parameters])
        self._known: dict[bytes, CurveAnswer] = {}
        self.evaluations = 0
        self.best: CurveAnswer

    def solve(self) -> optimize.OptimizeResult:
        """Search, and judge the curve of what is found; collective."""
        start = np.array([one.start for one in self._parameters]) / self._scales
        low = np.array([one.low for one in self._parameters]) / self._scales
        high = np.array([one.high for one in self._parameters]) / self._scales
        inside = _inside(start, low, high)
        self._begin(inside)
        found = optimize.least_squares(
            self._residual,
            inside,
            jac=self._slopes,
            bounds=(low, high),
            method="trf",
            ftol=_SUM / max(1, len(self._measured) - len(self._parameters)),
            xtol=_STEP,
            gtol=None,
            max_nfev=MOST,
        )
        self.best = self._evaluate(found.x, is_judged=True)
        return found

    def _begin(self, start: Array) -> None:
        """Evaluate the start, where nothing may go wrong; collective."""
        try:
            self._known[start.tobytes()] = self._evaluate(start)
        except InputError as error:
            said = str(error).removeprefix("of: ").replace("by: ", "--parameters ", 1)
            source = self._measured.source
            whole = said if said.startswith((source, "--parameters")) else f"{source}: {said}"
            raise InputError(whole) from None
        moves = self._moves(self._known[start.tobytes()])
        if not moves.all():
            parameter = self._parameters[int(np.argmin(moves))]
            raise InputError(
                f"--parameters {parameter.key}: the curve does not depend on it where the search "
                f"begins; leave it out, or begin elsewhere with --set {parameter.key}=VALUE"
            )

    def _moves(self, answer: CurveAnswer) -> Flags:
        """Whether the curve follows each parameter by more than round-off, (parameters,)."""
        moved = np.abs(answer.slopes * self._scales).max(axis=0)
        return np.asarray(moved > _NOTHING * np.abs(answer.values).max())

    def _evaluate(self, scaled: Array, is_judged: bool = False) -> CurveAnswer:
        values = self._values(scaled)
        self.evaluations += 1
        solve = partial(self._curve.answer, self._study, values, is_judged)
        known = self._journal
        found = solve() if known is None else known.answer(values, is_judged, solve)
        said = ", ".join(f"{key} = {value:.6g}" for key, value in values.items())
        apart = np.sqrt(np.mean((found.values - self._measured.values) ** 2))
        logger.info("curve %d: %s: residual %.4g", self.evaluations, said, apart)
        return found

    def _values(self, scaled: Array) -> dict[str, float]:
        pairs = zip(self._parameters, scaled * self._scales, strict=True)
        return {parameter.key: float(value) for parameter, value in pairs}

    @property
    def _deviation(self) -> Array:
        """Deviations by which rows are weighted: their uncertainties, or the same for all."""
        known = self._measured.uncertainties
        size = float(np.abs(self._measured.values).max()) or 1.0
        return np.full(len(self._measured), size) if known is None else known

    def _residual(self, scaled: Array) -> Array:
        """Return residuals of the rows over their deviations; not finite without an answer."""
        key = scaled.tobytes()
        if key not in self._known:
            try:
                self._known[key] = self._evaluate(scaled)
            except (InputError, NotConvergedError) as error:
                logger.info("curve %d: %s; a smaller step", self.evaluations, error)
                return np.full(len(self._measured), np.nan)
        return np.asarray((self._known[key].values - self._measured.values) / self._deviation)

    def _slopes(self, scaled: Array) -> Array:
        slopes = self._known[scaled.tobytes()].slopes
        return np.asarray(slopes * self._scales / self._deviation[:, None])

    def record(self, found: optimize.OptimizeResult) -> FitRecord:
        """Return the content of ``fit.json``.

        Args:
            found: Of the search.
        """
        measured, answer = self._measured, self.best
        residual = answer.values - measured.values
        free = len(measured) - len(self._parameters)
        if measured.uncertainties is None:
            deviation = np.full(len(measured), np.sqrt(float(residual @ residual) / free))
            deviation = np.maximum(deviation, np.finfo(float).tiny)
            misfit, freedom = None, free
        else:
            deviation, freedom = measured.uncertainties, None
            squares = float(np.sum((residual / deviation) ** 2))
            misfit = squares / free if free else None
        slopes = np.where(self._moves(answer), answer.slopes, 0.0)
        intervals = Intervals(slopes, deviation, freedom, answer.errors)
        values = self._values(found.x)
        parameters = {
            one.key: self._fitted(number, one, values[one.key], intervals)
            for number, one in enumerate(self._parameters)
        }
        scene, keys = self._study.scene, list(values)
        failed = {name for checks in answer.checks for name in checks if not checks[name].passed}
        converged = bool(found.status > 0)
        return FitRecord(
            parameters=parameters,
            confidence=CONFIDENCE,
            residual=float(np.sqrt(np.mean(residual**2))),
            evaluations=self.evaluations,
            converged=converged,
            verdict=verdict_of(parameters, converged, sorted(failed)),
            quantity=measured.quantity,
            over=list(measured.over),
            rows=len(measured),
            misfit=misfit,
            correlations=intervals.correlations.tolist(),
            singular_values=intervals.singular_values.tolist(),
            notes=notes_of(keys, intervals, parameters, misfit, free),
            checks=sorted(failed),
            title=scene.title,
            measured=measured.source,
            units=units_of(scene, [measured.quantity]),
        )

    def _fitted(
        self, number: int, parameter: Parameter, value: float, intervals: Intervals
    ) -> FittedParameter:
        close = _AT_BOUND * parameter.scale
        at_bound = min(value - parameter.low, parameter.high - value) <= close
        if not intervals.is_known(number):
            return FittedParameter(
                value=value,
                low=None,
                high=None,
                start=parameter.start,
                noise=None,
                discretisation=None,
                at_bound=bool(at_bound),
            )
        half = float(intervals.half_widths[number])
        has_errors = "mesh" in intervals.errors
        return FittedParameter(
            value=value,
            low=max(value - half, parameter.low),
            high=min(value + half, parameter.high),
            start=parameter.start,
            noise=float(intervals.half_widths_by_noise[number]),
            discretisation=float(intervals.discretisation[number]) if has_errors else None,
            at_bound=bool(at_bound),
        )


def _inside(start: Array, low: Array, high: Array) -> Array:
    """A start at a bound is moved off it by a little, as the search begins inside."""
    room = np.where(np.isfinite(high - low), high - low, 1.0)
    return np.asarray(np.clip(start, low + 1e-3 * room, high - 1e-3 * room))
