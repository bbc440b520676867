"""Reading ``result.json``, and refusing one that pages and pictures cannot be made of."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from pydantic import TypeAdapter, ValidationError

from fenics_contact.common.errors import InputError
from fenics_contact.results.earlier_results import result_in_todays_terms

_Numbers = dict[str, Any]  # a vector's value is a list


@dataclass
class _Model:
    kinematics: Literal["plane strain", "plane stress", "axisymmetric", "3D"]
    contact_points: int


@dataclass
class _Check:
    value: float | None
    limit: float | None
    passed: bool


@dataclass
class _Contact:
    name: str
    contact: str
    law: str
    parameters: dict[str, Any]
    quantities: _Numbers


@dataclass
class _Support:
    on: str
    reaction: list[float | None]


@dataclass
class _Step:
    load_factor: float
    newton_iterations: int
    outer_iterations: int
    quantities: _Numbers


@dataclass
class _Timings:
    total: float


@dataclass
class _Content:
    """The keys that pages and pictures rely on; a file has more."""

    title: str
    converged: bool
    passed: bool
    verdict: str
    scene: str
    model: _Model
    contacts: list[_Contact]
    supports: list[_Support]
    quantities: _Numbers
    steps: list[_Step]
    checks: dict[str, _Check]
    timings: _Timings
    versions: dict[str, str]


_EXPECTED = TypeAdapter(_Content)


def read_result(folder: Path) -> dict[str, Any]:
    """The content of a run's ``result.json``, in today's terms if an earlier version wrote it.

    Raises:
        InputError: There is none, or it is not one of this program; says what is wrong.
    """
    path = folder / "result.json"
    try:
        result = json.loads(path.read_text(encoding="utf-8"))
        _EXPECTED.validate_python(result)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    except ValidationError as error:
        raise InputError(f"{path}: not a result of this program: {_said(error)}") from None
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: not a result of this program: {error}") from None
    assert isinstance(result, dict)
    return result_in_todays_terms(result)


def _said(error: ValidationError) -> str:
    """The first thing that is wrong, and where."""
    first = error.errors(include_url=False)[0]
    place = ".".join(map(str, first["loc"]))
    if first["type"] == "missing":
        return f"it lacks the key '{place}'"
    return f"{place or 'the whole'}: {first['msg'][0].lower()}{first['msg'][1:]}"
