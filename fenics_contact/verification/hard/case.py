"""What a hard case is: runs that must be right, or end in words that name the reason.

An answer that differs from its reference, or that is given where there is none, is *silently
wrong*: the worst that can happen, and counted by itself.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Literal

from mpi4py import MPI

from fenics_contact.common.errors import FenicsContactError
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.scene_run import Run
from fenics_contact.verification.case import Finding, as_row

Ending = Literal["solved", "refused", "not converged", "untrusted", "failed"]
_ENDINGS: dict[int, Ending] = {0: "solved", 2: "refused", 3: "not converged", 4: "untrusted"}


@dataclass(frozen=True)
class HardCase:
    """A hard case.

    Attributes:
        name: For the command line.
        theme: Of the cases that it stands among.
        difficulty: What is hard about it, in a few words.
        source: Where the reference comes from, or why there is no answer.
        run: Solves by ``Trials`` and compares; collective, and the findings are the same on every
            rank.
        expected: How it may end.
        reason: What the message must hold where it does not end with an answer (a regular
            expression).
    """

    name: str
    theme: str
    difficulty: str
    source: str
    run: Callable[[Trials], Iterator[Finding]]
    expected: tuple[Ending, ...] = ("solved",)
    reason: str = ""


@dataclass(frozen=True)
class Trial:
    """A run of a case, and what the program said of it.

    Attributes:
        exit_code: As of ``fenics-contact run``.
        sentence: The verdict, or the message.
        newton: Newton steps, of all load steps together.
        outer: Passes of the loop on the pressure.
    """

    exit_code: int
    sentence: str
    newton: int = 0
    outer: int = 0

    @property
    def ending(self) -> Ending:
        """The exit code in words."""
        return _ENDINGS.get(self.exit_code, "failed")


class NoAnswerError(Exception):
    """A run ended without an answer to compare; what it said has been kept."""


class ReferenceFailedError(FenicsContactError):
    """The reference of a case could not be found."""


class Trials:
    """Runs scenes as the command line does, and keeps how they ended; collective."""

    def __init__(self) -> None:
        self.done: list[Trial] = []

    def solve(self, scene: Scene, body: Body | None = None) -> Result:
        """Solve a scene.

        Raises:
            NoAnswerError: It was refused, did not converge, or a check failed.
        """
        return self.solve_keeping(scene, body)[1]

    def solve_keeping(self, scene: Scene, body: Body | None = None) -> tuple[Run, Result]:
        """The same with the run, for its fields.

        Raises:
            NoAnswerError: As above.
        """
        try:
            run = Run(scene, MPI.COMM_WORLD, body)
            result = run.solve()
        except FenicsContactError as error:
            self.done.append(Trial(error.exit_code, str(error)))
            raise NoAnswerError from None
        newton, outer = (
            sum(int(step[key]) for step in result.steps)
            for key in ("newton_iterations", "outer_iterations")
        )
        self.done.append(Trial(result.exit_code, result.verdict, newton, outer))
        if result.exit_code:
            raise NoAnswerError
        return run, result


@dataclass(frozen=True)
class HardOutcome:
    """A hard case that was run.

    Attributes:
        case: The case.
        trials: Its runs, in order.
        findings: What was compared.
        seconds: For all.
        note: Why the reference is missing, if it is.
    """

    case: HardCase
    trials: tuple[Trial, ...]
    findings: tuple[Finding, ...]
    seconds: float
    note: str = ""

    @property
    def decisive(self) -> Trial:
        """The run that gave no answer, else the one with most Newton steps."""
        for trial in self.trials:
            if trial.exit_code:
                return trial
        return max(self.trials, key=lambda trial: trial.newton)

    @property
    def ending(self) -> Ending:
        """How it ended."""
        return self.decisive.ending

    @property
    def is_silently_wrong(self) -> bool:
        """Whether an answer was given for good that is wrong, or where there is none."""
        if self.ending != "solved" or self.note:
            return False
        return "solved" not in self.case.expected or not self._agrees

    @property
    def passed(self) -> bool:
        """Whether it ended as it may: rightly solved, or without an answer for the right reason."""
        if self.note or self.ending not in self.case.expected:
            return False
        if self.ending == "solved":
            return self._agrees
        return re.search(self.case.reason, self.decisive.sentence) is not None

    @property
    def _agrees(self) -> bool:
        """Whether something was compared, and all of it is right."""
        return bool(self.findings) and all(finding.passed for finding in self.findings)

    @property
    def worst(self) -> Finding | None:
        """The finding nearest to its limit or farthest beyond; None where nothing was compared."""
        if not self.findings:
            return None

        def used(finding: Finding) -> float:
            share = finding.error / finding.tolerance if finding.tolerance else finding.error
            return share if share == share else float("inf")  # not a number is the worst of all

        return max(self.findings, key=used)

    @property
    def judgement(self) -> str:
        """In a word or two."""
        if self.is_silently_wrong:
            return "SILENTLY WRONG"
        return "passed" if self.passed else "FAILED"

    def as_dict(self) -> dict[str, Any]:
        """For ``--json``."""
        decisive = self.decisive
        return {
            "name": self.case.name,
            "theme": self.case.theme,
            "difficulty": self.case.difficulty,
            "expected": list(self.case.expected),
            "found": self.ending,
            "exit_code": decisive.exit_code,
            "sentence": decisive.sentence,
            "newton": decisive.newton,
            "outer": decisive.outer,
            "source": self.case.source,
            "findings": [as_row(finding) for finding in self.findings],
            "seconds": self.seconds,
            "passed": self.passed,
            "silently_wrong": self.is_silently_wrong,
            "note": self.note,
        }


def run_hard_case(case: HardCase) -> HardOutcome:
    """Run a hard case; collective."""
    started = time.perf_counter()
    trials, findings, note = Trials(), [], ""
    try:
        for finding in case.run(trials):
            findings.append(finding)
    except NoAnswerError:
        findings.clear()  # of an answer that was not given in full
    except ReferenceFailedError as error:
        note = str(error)
    seconds = MPI.COMM_WORLD.allreduce(time.perf_counter() - started, op=MPI.MAX)
    return HardOutcome(case, tuple(trials.done), tuple(findings), seconds, note)
