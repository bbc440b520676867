"""Reading ``result.json``, and refusing one that pages and pictures cannot be made of."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from fenics_contact.common.errors import InputError
from fenics_contact.results.records.run import RunRecord
from fenics_contact.results.records.steps import StepRecord


@cache
def _reader_of(kind: Any) -> TypeAdapter[Any]:
    """Made when first needed: a run that reads no file does without."""
    return TypeAdapter(kind)


def read_result(folder: Path) -> RunRecord:
    """The content of a run's ``result.json``.

    Raises:
        InputError: There is none, or it is not one of this program; says what is wrong.
    """
    path = folder / "result.json"
    try:
        return record_of(json.loads(path.read_text(encoding="utf-8")))
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    except ValidationError as error:
        raise InputError(f"{path}: not a result of this program: {_said(error)}") from None
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: not a result of this program: {error}") from None


def record_of(content: Any) -> RunRecord:
    """Return the record of the content of a ``result.json``.

    Raises:
        ValidationError: It is not one of this program.
    """
    reader: TypeAdapter[RunRecord] = _reader_of(RunRecord)
    return reader.validate_python(content)


def steps_of(content: list[dict[str, Any]]) -> list[StepRecord]:
    """Load steps as they stand in a file.

    Raises:
        ValidationError: They are not those of this program.
    """
    reader: TypeAdapter[list[StepRecord]] = _reader_of(list[StepRecord])
    return reader.validate_python(content)


def _said(error: ValidationError) -> str:
    """The first thing that is wrong, and where."""
    first = error.errors(include_url=False)[0]
    place = ".".join(map(str, first["loc"]))
    if first["type"] == "missing":
        return f"it lacks the key '{place}'"
    return f"{place or 'the whole'}: {first['msg'][0].lower()}{first['msg'][1:]}"
