"""The runs that are compared, from their folders."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from fenics_contact.common.errors import InputError
from fenics_contact.common.plain_text import one_line
from fenics_contact.results.records.run import RunRecord
from fenics_contact.results.records.units import UnitsRecord
from fenics_contact.results.result_file import read_result

_SWEEP = ("sweep.json", "sweep.csv")


@dataclass(frozen=True)
class ComparedRun:
    """A run with its name in a comparison.

    Attributes:
        name: Of its folder; the folder's path where several have this name.
        folder: Where its files are.
        result: The content of its ``result.json``.
    """

    name: str
    folder: Path
    result: RunRecord

    @property
    def outcome(self) -> str:
        """In a few words what came out."""
        checks = self.result.checks.values()
        failed = sum(not check.passed for check in checks)
        if not self.result.converged:
            return "not converged"
        if failed:
            return f"{failed} of {len(checks)} checks FAILED"
        words = f"converged, all {len(checks)} checks passed"
        return words if self.result.passed else f"{words}, but not as accurate as was asked for"


def read_runs(folders: Sequence[Path]) -> list[ComparedRun]:
    """The runs of some folders, in their order.

    Args:
        folders: Two or more.

    Raises:
        InputError: There are fewer, one is none of a run or is given twice, or the numbers of two
            runs are in different units.
    """
    if len(folders) < 2:
        raise InputError("compare: takes the folders of two runs or more")
    places = [folder.resolve() for folder in folders]
    for number, place in enumerate(places):
        if place in places[:number]:
            raise InputError(f"compare: the folder '{folders[number]}' is given twice")
    names = [place.name for place in places]
    named = [
        str(folder) if names.count(place.name) > 1 else place.name
        for folder, place in zip(folders, places, strict=True)
    ]
    runs = [
        ComparedRun(one_line(name), folder, _read(folder))
        for name, folder in zip(named, folders, strict=True)
    ]
    _require_same_units(runs)
    return runs


def _read(folder: Path) -> RunRecord:
    if folder.is_file():
        raise InputError(f"{folder}: is a file; compare takes the folders of runs")
    if not (folder / "result.json").exists() and any((folder / name).exists() for name in _SWEEP):
        raise InputError(
            f"{folder}: is the folder of a sweep, whose runs are side by side in its sweep.html; "
            "compare takes the folders of runs"
        )
    return read_result(folder)


def _require_same_units(runs: list[ComparedRun]) -> None:
    """Refuse numbers of different units; those of a run that says none are taken as the others'."""
    said = {run.name: _words(run.result.units) for run in runs if run.result.units is not None}
    for name, words in said.items():
        first, expected = next(iter(said.items()))
        if words != expected:
            raise InputError(
                f"compare: numbers of '{first}' are in {expected}, those of '{name}' in {words}: "
                "give both scenes the same [units], and run one of them again"
            )


def _words(units: UnitsRecord) -> str:
    return f"{units.of('length')} and {units.of('force')}"


def units_of(runs: Sequence[ComparedRun]) -> UnitsRecord | None:
    """Return the units of all numbers, if any run has units.

    Args:
        runs: That are compared.
    """
    return next((run.result.units for run in runs if run.result.units is not None), None)
