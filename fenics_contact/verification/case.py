"""What a benchmark is: runs that give findings, each compared with a reference."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any

import numpy as np

from fenics_contact.common.errors import FenicsContactError
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.records.run import Model
from fenics_contact.results.result import Result
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.runs import run


@dataclass(frozen=True)
class Finding:
    """A number that was computed, beside the one it should be.

    Attributes:
        quantity: What it is, in the words of ``result.json`` where it is one of them.
        value: As computed.
        reference: As it should be, in the same unit.
        tolerance: Largest error that passes.
        absolute: Whether the error is a difference in the quantity's unit, not relative.
        note: Why there is no value.
        bar: Estimated absolute error of the value, in its unit; None where there is none.
    """

    quantity: str
    value: float
    reference: float
    tolerance: float
    absolute: bool = False
    note: str = ""
    bar: float | None = None

    @property
    def estimated_error(self) -> float | None:
        """The bar, relative where the error is."""
        if self.bar is None or self.absolute:
            return self.bar
        return self.bar / abs(self.reference)

    @property
    def error(self) -> float:
        """Distance from the reference, ≥ 0; not a number if there is no value."""
        difference = abs(self.value - self.reference)
        return difference if self.absolute else difference / abs(self.reference)

    @property
    def passed(self) -> bool:
        """Whether the error is within the tolerance; one that is not a number is not."""
        return bool(self.error <= self.tolerance)


@dataclass(frozen=True)
class Case:
    """A benchmark.

    Attributes:
        name: For the command line.
        summary: One line for its help.
        source: Where the references come from.
        run: Solves and compares; its argument asks for the quick version. Collective, and the
            findings are the same on every rank.
    """

    name: str
    summary: str
    source: str
    run: Callable[[bool], Iterator[Finding]]


@dataclass(frozen=True)
class Outcome:
    """A case that was run.

    Attributes:
        case: The case.
        findings: What it gave, at least one.
        seconds: For all of them together.
        meshes: What was solved, a sentence each; none for cases whose runs are processes.
    """

    case: Case
    findings: tuple[Finding, ...]
    seconds: float
    meshes: tuple[str, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether all of its findings are."""
        return all(finding.passed for finding in self.findings)

    def rows(self) -> list[dict[str, Any]]:
        """For ``--json``: a row a finding, null for what is not a number."""
        return [
            {
                "name": self.case.name,
                "source": self.case.source,
                "estimated_error": finding.estimated_error,
                "seconds": self.seconds,
                "meshes": list(self.meshes),
                **as_row(finding),
            }
            for finding in self.findings
        ]


def as_row(finding: Finding) -> dict[str, Any]:
    """A finding for ``--json``: null for what is not a number."""
    return {
        "quantity": finding.quantity,
        "value": _number(finding.value),
        "reference": _number(finding.reference),
        "error": _number(finding.error),
        "absolute": finding.absolute,
        "tolerance": finding.tolerance,
        "passed": finding.passed,
        "note": finding.note,
    }


# Of the runs that are under way: which meshes ``solved`` has seen, in their order.
_MESHES: ContextVar[dict[str, None] | None] = ContextVar("meshes", default=None)


@contextmanager
def noting_meshes() -> Iterator[dict[str, None]]:
    """While it lasts, ``solved`` notes in what is given what it solves: a sentence a mesh."""
    noted: dict[str, None] = {}
    token = _MESHES.set(noted)
    try:
        yield noted
    finally:
        _MESHES.reset(token)


def note_mesh(model: Model) -> None:
    """Note what a case has solved, if somebody asked for it."""
    if (noted := _MESHES.get()) is not None:
        noted[mesh_in_words(model)] = None


def mesh_in_words(model: Model) -> str:
    """Kinematics, cells and unknowns of a run."""
    points = f", {model.contact_points:,} contact points" if model.contact_points else ""
    return (
        f"{model.kinematics}: {model.cells:,} cells ({model.cell}), displacements of degree "
        f"{model.degree}, {model.dofs:,} unknowns{points}"
    )


class UntrustedError(FenicsContactError):
    """A run of a case found no answer, or one that a check of the physics refuses."""


def solved(scene: Scene, body: Body | None = None) -> Result:
    """Solve a scene of a case; collective.

    Args:
        scene: The scene.
        body: Its mesh, if that is not the one that it names.

    Raises:
        UntrustedError: It did not converge, or a check failed.
    """
    result = run(scene, body=body)
    note_mesh(result.model)
    if not result.passed:
        raise UntrustedError(result.verdict)
    return result


def of_quantity(
    result: Result, quantity: str, reference: float, tolerance: float, label: str = ""
) -> Finding:
    """A quantity of a result, of vectors the length, with its error bar."""
    value = math.hypot(*np.atleast_1d(result.quantities[quantity]))
    bar = result.errors.get(quantity, {}).get("total")
    return Finding(f"{quantity}{label}", value, reference, tolerance, bar=bar)


def radius_of_area(
    result: Result, quantity: str, label: str, reference: float, tolerance: float
) -> Finding:
    """Radius of the circle that has the area of a quantity, with its error bar."""
    area = result.quantities[quantity]
    bar = result.errors.get(quantity, {}).get("total")
    radius = math.sqrt(area / math.pi)
    bar = None if bar is None else 0.5 * radius * bar / area
    return Finding(label, radius, reference, tolerance, bar=bar)


def no_value(error: FenicsContactError) -> Finding:
    """In place of the findings that an error prevented."""
    return Finding("run", math.nan, math.nan, 0.0, note=str(error))


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None
