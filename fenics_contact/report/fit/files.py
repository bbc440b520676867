"""Reading the files of a fit, and refusing those that a page cannot be made of."""

from __future__ import annotations

import csv
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import TypeAdapter, ValidationError

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.results.fit_record import CURVE, RECORD, FitRecord

_UNCERTAINTY = "_error"


@dataclass(frozen=True, eq=False)
class FittedCurve:
    """The content of ``fit.csv``.

    Attributes:
        over: Name of what the curve is over → its values, (rows,).
        measured: (rows,).
        uncertainties: Standard uncertainties, (rows,); None where they are not known.
        run: Of the run with the values found, (rows,).
    """

    over: dict[str, Array]
    measured: Array
    uncertainties: Array | None
    run: Array

    @property
    def residual(self) -> Array:
        """Difference of the run and the data, (rows,)."""
        return np.asarray(self.run - self.measured)


def read_fit(folder: Path) -> tuple[FitRecord, FittedCurve]:
    """Read the files of a fit from its folder.

    Args:
        folder: With ``fit.json`` and ``fit.csv``.

    Raises:
        InputError: A file is missing or damaged, or they are of different fits.
    """
    path = folder / RECORD
    try:
        reader: TypeAdapter[FitRecord] = TypeAdapter(FitRecord)
        record = reader.validate_python(json.loads(path.read_text(encoding="utf-8")))
        path = folder / CURVE
        return record, _curve(path, record)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from None
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        said = f"{'.'.join(map(str, first['loc'])) or 'the whole'}: {first['msg']}"
        raise InputError(f"{path}: damaged: {said}; fit again") from None
    except (ValueError, KeyError, RecursionError, csv.Error) as error:
        raise InputError(f"{path}: damaged: {error}; fit again") from None


def _curve(path: Path, record: FitRecord) -> FittedCurve:
    """The table, whose columns and rows the record says.

    Raises:
        ValueError: They are others.
    """
    with path.open(newline="", encoding="utf-8") as file:
        head, *rows = list(csv.reader(file)) or [[]]
    known = record.quantity + _UNCERTAINTY in head
    bars = [record.quantity + _UNCERTAINTY] if known else []
    if head != [*record.over, record.quantity, *bars, "run", "residual"]:
        raise ValueError(f"its first line is not that of a fit of {record.quantity}")
    if len(rows) != record.rows:
        raise ValueError(f"it has {len(rows)} rows, but the fit has {record.rows}")
    columns = dict(zip(head, np.array(rows, dtype=np.float64).T, strict=True))
    return FittedCurve(
        over={name: columns[name] for name in record.over},
        measured=columns[record.quantity],
        uncertainties=columns[bars[0]] if known else None,
        run=columns["run"],
    )
