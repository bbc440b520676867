"""Action and output of ``fenics-contact fit``: ``fit.json``, ``fit.csv``, the scene found."""

from __future__ import annotations

import argparse
import csv
import dataclasses
import io
import json
import logging
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from mpi4py import MPI

from fenics_contact.common.atomic_files import make_folder, naming, replace_file
from fenics_contact.common.errors import InputError, StoppedError
from fenics_contact.common.failures import original
from fenics_contact.common.wording import one_line
from fenics_contact.report.page.fit import interval_in_words, write_fit_page
from fenics_contact.results.fit_record import CURVE, PAGE, RECORD, FitRecord
from fenics_contact.scene.reading import load_scene
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.writing import SCENE_FILE, write_scene
from fenics_contact.simulation.fits.fit import Fit
from fenics_contact.simulation.fits.fit import fit as find
from fenics_contact.simulation.fits.journal import NAME, FitJournal
from fenics_contact.simulation.fits.measured import UNCERTAINTY, parameters_of, read_measured
from fenics_contact.simulation.output.run_folder import require_writable
from fenics_contact.simulation.studies.study import Study

logger = logging.getLogger(__name__)


def fit(options: argparse.Namespace) -> int:
    """Find values of a scene's numbers, write what was found, and return the exit code.

    Args:
        options: Of the command line.

    Raises:
        InputError: It is wrong, or the scene or the data cannot be used.
        NotConvergedError: The scene has no answer where the search begins.
        StoppedError: It was interrupted; curves that are done are kept.
        MachineError: The machine failed.
    """
    if MPI.COMM_WORLD.size > 1:  # before each of them reads the scene
        raise InputError("fit: it runs on one rank; start it without mpirun")
    words = [word.strip() for words in options.parameters for word in words.split(",")]
    if not words:
        raise InputError("fit: --parameters KEY[=LOW:HIGH],… is missing")
    folder = options.out or Path("results") / f"{options.scene.stem}_fit"
    require_writable(folder, MPI.COMM_SELF)
    study = Study(load_scene(options.scene, options.overrides), MPI.COMM_SELF)
    try:
        found = _found(study, options, words, folder)
    finally:
        study.close()
    record = write_fit(folder, found, study.changed(found.changes), str(options.scene))
    _draw(folder)
    if not options.quiet or record.exit_code:
        print("\n".join(one_line(line) for line in _said(record, folder)))
    return record.exit_code


def _found(study: Study, options: argparse.Namespace, words: list[str], folder: Path) -> Fit:
    """Return the result of the search, with a journal of its curves.

    Raises:
        StoppedError: It was interrupted, after curves that are kept.
    """
    measured = read_measured(options.measured, study.scene, options.of)
    chosen = parameters_of(study.scene, words)
    journal = FitJournal(folder, study.scene, measured, chosen, options.resume)
    try:
        return find(study, measured, words, journal=journal)
    except (Exception, KeyboardInterrupt) as error:
        if journal.is_there and isinstance(original(error), KeyboardInterrupt):
            raise StoppedError(
                "interrupted; --resume goes on from the curves that are done"
            ) from None
        raise
    finally:
        journal.close()


def _draw(folder: Path) -> None:
    """The page: the files stand without it."""
    try:
        write_fit_page(folder)
    except InputError as error:
        logger.warning("no page: %s", error)


def _said(record: FitRecord, folder: Path) -> Iterator[str]:
    """Values and intervals, what to know of them, and the files."""
    for key in record.parameters:
        yield f"{key} = {interval_in_words(record, key)}"
    yield f"{record.verdict} {record.evaluations} curves were solved for."
    yield from record.notes
    names = (RECORD, CURVE, SCENE_FILE, PAGE, NAME)
    written = [name for name in names if (folder / name).exists()]
    yield f"Wrote {', '.join(written)} in {folder}"


#: Columns behind what was measured.
RUN, RESIDUAL = "run", "residual"


def write_fit(folder: Path, found: Fit, scene: Scene, source: str) -> FitRecord:
    """Write the files of a fit; those of an earlier one are replaced.

    Args:
        folder: Where to.
        found: What was found.
        scene: With these values.
        source: The scene's file as it was given.

    Returns:
        What stands in ``fit.json``.

    Raises:
        MachineError: A file could not be written.
    """
    make_folder(folder)
    with naming(folder):
        (folder / PAGE).unlink(missing_ok=True)
    record = dataclasses.replace(found.record, scene=source)
    content = json.dumps(_finite(record.as_dict()), indent=2, ensure_ascii=False, allow_nan=False)
    replace_file(folder / CURVE, _curve(found).encode())
    write_scene(scene, folder)
    replace_file(folder / RECORD, f"{content}\n".encode())
    return record


def _curve(found: Fit) -> str:
    """Both curves, a row a row of the data."""
    measured, text = found.measured, io.StringIO(newline="")
    known = measured.uncertainties
    names = [*measured.over, measured.quantity]
    names += [] if known is None else [measured.quantity + UNCERTAINTY]
    writer = csv.writer(text)
    writer.writerow([*names, RUN, RESIDUAL])
    for row, (value, fitted) in enumerate(zip(measured.values, found.values, strict=True)):
        numbers = [*measured.at[row], value, *([] if known is None else [known[row]])]
        writer.writerow([repr(float(one)) for one in (*numbers, fitted, fitted - value)])
    return text.getvalue()


def _finite(content: Any) -> Any:
    """With null in place of what is no finite number, as in ``result.json``."""
    if isinstance(content, dict):
        return {key: _finite(value) for key, value in content.items()}
    if isinstance(content, list):
        return [_finite(value) for value in content]
    return None if isinstance(content, float) and not math.isfinite(content) else content
