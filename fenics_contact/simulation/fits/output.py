"""The files of a fit: ``fit.json``, ``fit.csv`` and the scene with the values found."""

from __future__ import annotations

import csv
import dataclasses
import io
import json
import math
from pathlib import Path
from typing import Any

from fenics_contact.common.atomic_files import make_folder, naming, replace_file
from fenics_contact.results.fit_record import CURVE, PAGE, RECORD, FitRecord
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.writing import write_scene
from fenics_contact.simulation.fits.fit import Fit
from fenics_contact.simulation.fits.measured import UNCERTAINTY

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
