"""The journal of a fit: every curve that was solved for, so that a killed fit goes on.

A record is an ``.npz`` that holds values of the parameters and checks of the physics, as JSON, and
the curve with its derivatives and errors; or the values, and why there is no curve.
"""

from __future__ import annotations

import dataclasses
import io
import json
import logging
import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fenics_contact.common.atomic_files import naming
from fenics_contact.common.errors import InputError, NotConvergedError
from fenics_contact.results.fit_record import CURVE, PAGE, RECORD
from fenics_contact.results.records.record import plain
from fenics_contact.results.result import Check
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.writing import scene_text
from fenics_contact.simulation.fits.curves import CurveAnswer
from fenics_contact.simulation.fits.measured import Measured, Parameter
from fenics_contact.simulation.output.journal_file import JournalFile
from fenics_contact.simulation.sweeps.points import Contents, digest_of

logger = logging.getLogger(__name__)

NAME = "fit.journal"
_TEXT, _VALUES, _SLOPES, _ERRORS = "text", "values", "slopes", "errors of "
_FAILURES = {kind.exit_code: kind for kind in (InputError, NotConvergedError)}


class FitJournal:
    """The journal in a fit's folder, which is made once a curve was solved for; on one rank.

    Args:
        folder: Of the fit.
        scene: As the search begins.
        measured: The curve that is to be met.
        parameters: Those that are to be found.
        resume: Whether to take what an earlier fit in the folder has solved for.

    Raises:
        InputError: What is to be resumed is another fit, of another version, or damaged; or another
            job is being solved in the folder.
    """

    def __init__(
        self,
        folder: Path,
        scene: Scene,
        measured: Measured,
        parameters: Sequence[Parameter],
        resume: bool = False,
    ) -> None:
        parts = _scene_parts(scene) | {
            "the measured curve": _digest_of_curve(measured),
            "the parameters": digest_of([[one.key, one.low, one.high] for one in parameters]),
        }
        self._file = JournalFile(folder / NAME, "fit", parts)
        self._known: dict[str, bytes] = {}
        if resume:
            self._file.resume(self._is_kept)
            said = "'%s' has %d curves, which are not solved for again"
            logger.info(said, self._file.path, len(self._known))
        else:
            self._file.lock.take()

    @property
    def is_there(self) -> bool:
        """Whether there is one of this fit."""
        return self._file.is_there

    def answer(
        self, values: Mapping[str, float], is_judged: bool, solve: Callable[[], CurveAnswer]
    ) -> CurveAnswer:
        """A curve from the journal, or else solved for and kept there.

        Args:
            values: Of the parameters, by their keys.
            is_judged: Whether it is checked, with errors.
            solve: Solves for it.

        Raises:
            InputError: There is no curve for these values, now or when they were tried before; or
                another job has begun in the folder meanwhile.
            NotConvergedError: Likewise.
            MachineError: The journal could not be written.
        """
        of = json.dumps([dict(values), is_judged], sort_keys=True)
        if of in self._known:
            return _unpacked(self._known[of])
        try:
            found = solve()
        except (InputError, NotConvergedError) as error:
            failure = {"of": of, "exit_code": error.exit_code, "said": str(error)}
            # Where nothing can be solved, no folder is made.
            self._file.add(_packed(failure, {}), _clear, waits=True)
            raise
        self._file.add(_packed_answer(of, found), _clear)
        return found

    def close(self) -> None:
        """Let others into the folder."""
        self._file.lock.give_up()

    def _is_kept(self, content: bytes) -> bool:
        text, arrays = _read(content)
        if "exit_code" not in text:
            _answer_of(text, arrays)
        self._known[text["of"]] = content
        return True


def _scene_parts(scene: Scene) -> dict[str, str]:
    """Digests of all keys of a scene that have not their defaults, and of its meshes' content."""
    said = tomllib.loads(scene_text(scene))
    found = {f"{key} of the scene": digest_of(part) for key, part in said.items() if key != "title"}
    return found | {"the content of the mesh file": digest_of(Contents().of(scene))}


def _digest_of_curve(measured: Measured) -> str:
    numbers = (measured.at, measured.values, measured.uncertainties)
    return digest_of([measured.over, measured.quantity, *map(plain, numbers)])


def _clear(folder: Path) -> None:
    """Remove the files of an earlier fit."""
    with naming(folder):
        for name in (RECORD, CURVE, PAGE):
            (folder / name).unlink(missing_ok=True)


def _packed(text: Mapping[str, Any], arrays: Mapping[str, Any]) -> bytes:
    file = io.BytesIO()
    np.savez(file, allow_pickle=False, **{_TEXT: np.array(json.dumps(plain(text)))}, **arrays)
    return file.getvalue()


def _packed_answer(of: str, found: CurveAnswer) -> bytes:
    checks = [
        {name: dataclasses.asdict(check) for name, check in one.items()} for one in found.checks
    ]
    errors = {_ERRORS + source: drawn for source, drawn in found.errors.items()}
    arrays = {_VALUES: found.values, _SLOPES: found.slopes, **errors}
    return _packed({"of": of, "checks": checks}, arrays)


def _read(content: bytes) -> tuple[dict[str, Any], dict[str, Any]]:
    with np.load(io.BytesIO(content), allow_pickle=False) as found:
        arrays = dict(found)
    return json.loads(str(arrays.pop(_TEXT))), arrays


def _unpacked(content: bytes) -> CurveAnswer:
    """Return a curve from the journal, or raise the error again with which its run ended."""
    text, arrays = _read(content)
    if "exit_code" in text:
        raise _FAILURES[text["exit_code"]](text["said"])
    return _answer_of(text, arrays)


def _answer_of(text: Mapping[str, Any], arrays: Mapping[str, Any]) -> CurveAnswer:
    return CurveAnswer(
        arrays[_VALUES],
        arrays[_SLOPES],
        {
            name.removeprefix(_ERRORS): drawn
            for name, drawn in arrays.items()
            if name.startswith(_ERRORS)
        },
        [{name: _check_of(kept) for name, kept in one.items()} for one in text["checks"]],
    )


def _check_of(kept: Mapping[str, Any]) -> Check:
    parts = tuple(_check_of(part) for part in kept["parts"])
    return Check(**{**kept, "place": tuple(kept["place"]), "parts": parts})
