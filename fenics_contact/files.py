"""Result files: ``result.json``, ``contact.csv`` and fields (see ``interface``)."""

from __future__ import annotations

import csv
import json
import math
import re
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from fenics_contact.errors import InputError
from fenics_contact.fields import write_fields
from fenics_contact.parallel import on_root
from fenics_contact.result import ContactPoints, Result
from fenics_contact.simulation import Run

CSV_HEADER = [
    *("contact", "x", "y", "z", "nx", "ny", "nz", "gap", "contact_pressure"),
    *("traction_x", "traction_y", "traction_z", "slip_x", "slip_y", "slip_z", "status"),
]


def require_writable(folder: Path, comm: MPI.Comm) -> None:
    """Refuse an output folder that cannot be made or written to, before any work.

    Raises:
        InputError: On every rank.
    """
    on_root(comm, lambda: _require_writable(folder))


def _require_writable(folder: Path) -> None:
    """Make the folder and a file in it, and take away again what was not there."""
    made = [path for path in (folder, *folder.parents) if not path.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise InputError(f"--out '{folder}': cannot be written to: {error.strerror}") from None
    finally:
        for path in made:
            if path.is_dir():
                path.rmdir()


def write(run: Run, result: Result, folder: Path) -> None:
    """Write the files of a run; collective.

    Without convergence they are of the last accepted load step; if there is none, only
    ``result.json`` is written, with the history. Files of an earlier run in the same folder are
    removed first, so that none outlives its run.
    """
    comm = run.problem.comm
    on_root(comm, lambda: _clear(folder))
    if run.solution is not None:
        write_fields(run.forces, folder)
    on_root(comm, lambda: _write_tables(result, folder))


# Files of a run and of its report, and nothing else that may lie in the folder.
_OWN_FILES = re.compile(
    r"result\.json|contact\.csv|report\.html|"
    r"(deformed|axis_stress|surface_displacement|contact_\d+)\.png|"
    r"fields\.pvd|fields\d{6}\.p?vtu|fields_p\d+_\d{6}\.vtu"
)


def _clear(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for path in folder.iterdir():
        if _OWN_FILES.fullmatch(path.name):
            path.unlink()


def _write_tables(result: Result, folder: Path) -> None:
    if result.points is not None:
        names = [contact["name"] for contact in result.contacts]
        _replace(folder / "contact.csv", _csv_rows(result.points, names))
    # Last, and in one move: where it exists, the run is complete.
    text = json.dumps(_finite(result.as_dict()), indent=2, ensure_ascii=False, allow_nan=False)
    temporary = folder / ".result.json"
    temporary.write_text(text + "\n", encoding="utf-8")
    temporary.replace(folder / "result.json")


def _csv_rows(points: ContactPoints, names: list[str]) -> list[list[str]]:
    columns = [
        _without_round_off(points.coordinates),
        _without_round_off(points.normals),
        # The gap is a difference of lengths; closed, round-off is most of it.
        _without_round_off(points.gap[:, None], np.abs(points.coordinates).max(initial=0.0)),
        _without_round_off(points.contact_pressure[:, None]),
        _without_round_off(points.friction_traction),
        _without_round_off(points.slip),
    ]
    table = np.hstack(columns)
    numbers = ",".join(["%.8g"] * table.shape[1])  # one format a row: there may be many
    rows = zip(points.contact.tolist(), table.tolist(), points.status.tolist(), strict=True)
    return [
        [names[contact], *(numbers % tuple(values)).split(","), state]
        for contact, values, state in rows
    ]


def _without_round_off(values: NDArray[np.float64], size: float = 0.0) -> NDArray[np.float64]:
    """Rounded to 1e-12 of the largest, or 1e-13 of a size, so that runs compare line by line."""
    finite = np.abs(values[np.isfinite(values)])
    unit = 1e-13 * size if size > 0 else 1e-12 * finite.max(initial=0.0)
    return np.round(values / unit) * unit + 0.0 if unit > 0 else values


def _replace(path: Path, rows: list[list[str]]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(CSV_HEADER)
        writer.writerows(rows)


def _finite(value: Any) -> Any:
    """JSON has no infinity: such numbers become null."""
    if isinstance(value, dict):
        return {key: _finite(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(entry) for entry in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
