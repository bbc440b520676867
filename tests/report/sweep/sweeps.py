"""Folders of sweeps as ``fenics-contact sweep`` writes them, with answers that are formulas."""

from __future__ import annotations

import base64
import csv
import gzip
import itertools
import json
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

RADIUS, MODULUS = 8.0, 1000 / (1 - 0.3**2)
INDENTATION, COEFFICIENT = "contact.0.obstacle.indentation", "contact.0.friction_coefficient"
ARRAYS = (
    *("point", "contact", "x", "y", "z", "gap", "contact_pressure"),
    *("traction_x", "traction_y", "traction_z", "slip_x", "slip_y", "slip_z", "status"),
)


@dataclass
class Answered:
    """An answer of one point: columns of the table, and the arrays of its contact points."""

    columns: dict[str, float | None]
    arrays: dict[str, np.ndarray] = field(default_factory=dict)
    code: int = 0


def line(count: int = 41) -> np.ndarray:
    x = np.linspace(0, 6, count)
    return np.column_stack([x, 0 * x, 0 * x])


def disc(count: int = 21) -> np.ndarray:
    x, y = np.meshgrid(np.linspace(-6, 6, count), np.linspace(-6, 6, count))
    return np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()])


def hertz(depth: float, coefficient: float = 0.5, at: np.ndarray | None = None) -> Answered:
    """Hertz's contact under a shear of half of what friction can carry (Cattaneo, Mindlin)."""
    at = line() if at is None else at
    force = 4 / 3 * MODULUS * math.sqrt(RADIUS) * depth**1.5
    radius = math.sqrt(RADIUS * depth)
    peak = 1.5 * force / (math.pi * radius**2)
    stick = radius * 0.5 ** (1 / 3)
    r = np.linalg.norm(at, axis=1)
    pressure = peak * np.sqrt(np.maximum(0, 1 - (r / radius) ** 2))
    inner = stick / radius * np.sqrt(np.maximum(0, 1 - (r / stick) ** 2))
    traction = coefficient * (pressure - peak * inner)
    none = np.zeros(len(at))
    status = np.where(r < stick, 1, np.where(r < radius, 2, 0))
    arrays = {
        "contact": none.astype(int), "x": at[:, 0], "y": at[:, 1], "z": at[:, 2],
        "gap": np.maximum(0, r**2 / (2 * RADIUS) - depth / 2) * (r >= radius),
        "contact_pressure": pressure, "traction_x": traction, "traction_y": none,
        "traction_z": none, "slip_x": -1e-3 * (status == 2) * r, "slip_y": none, "slip_z": none,
        "status": status.astype(np.int8),
    }  # fmt: skip
    columns = {
        "normal_force": force, "normal_force_error": 0.01 * force,
        "friction_force_x": coefficient * force / 2, "friction_force_y": 0.0,
        "friction_force_error": 0.02 * force,
        "max_contact_pressure": peak, "max_contact_pressure_error": None,
        "stick_area": math.pi * stick**2, "stick_area_error": 0.0321,
        "slip_area": math.pi * (radius**2 - stick**2), "slip_area_error": 0.05,
        "contact_radius": radius, "undecided_points": 3, "indentation": depth,
    }  # fmt: skip
    return Answered(columns, arrays)


def write_sweep(
    folder: Path,
    vary: Mapping[str, list[Any]],
    answer: Callable[..., Answered | str],
    **record: Any,
) -> Path:
    """Write the three files; a point whose answer is a sentence has failed for that reason."""
    folder.mkdir(parents=True, exist_ok=True)
    combinations = list(itertools.product(*vary.values()))
    found = [answer(*values) for values in combinations]
    failures = {row: said for row, said in enumerate(found) if isinstance(said, str)}
    answered = {row: one for row, one in enumerate(found) if isinstance(one, Answered)}
    heads = list(dict.fromkeys(name for one in answered.values() for name in one.columns))
    with (folder / "sweep.csv").open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([*vary, "exit_code", *heads])
        for row, values in enumerate(combinations):
            one = answered.get(row, Answered({}, code=3))
            cells = [one.columns.get(name) for name in heads]
            written = ["" if cell is None else repr(float(cell)) for cell in cells]
            writer.writerow([*values, one.code, *written])
    parts: dict[str, list[np.ndarray]] = {name: [] for name in ARRAYS}
    for row, one in answered.items():
        for name, array in one.arrays.items():
            parts[name].append(array)
        parts["point"].append(np.full(len(one.arrays["x"]), row))
    arrays = {name: np.concatenate(part) if part else np.zeros(0) for name, part in parts.items()}
    for name in ("point", "contact"):
        arrays[name] = arrays[name].astype(np.int64)
    arrays["status"] = arrays["status"].astype(np.int8)
    np.savez_compressed(folder / "states.npz", **arrays)
    whole = {
        "scene": "sphere.toml", "vary": vary, "rows": len(combinations), "answered": len(answered),
        "bulk_factorisations": 1, "seconds": 2.5, "title": "Sphere", "units": None,
        "contacts": ["top"], "failures": failures,
    }  # fmt: skip
    (folder / "sweep.json").write_text(json.dumps(whole | record))
    return folder


def data_of(page: Path) -> dict[str, Any]:
    """What a page's script draws from."""
    text = page.read_text(encoding="utf-8")
    (found,) = re.findall(r'id="sweep-data">([^<]*)<', text)
    return json.loads(gzip.decompress(base64.b64decode(found)))


def numbers_of(data: Mapping[str, Any], state: int, name: str) -> np.ndarray:
    """A field of a state, as the page unpacks it."""
    counts = [positions_of(data, number).shape[1] for _, _, number, *_ in data["states"]]
    start = sum(counts[:state])
    whole = np.frombuffer(base64.b64decode(data["fields"][name]), dtype="<i2")
    size = data["states"][state][3 + list(data["fields"]).index(name)]
    values = whole[start : start + counts[state]]
    return np.where(values == -32768, np.nan, values * size)


def positions_of(data: Mapping[str, Any], shape: int) -> np.ndarray:
    """Where the contact points of a shape are drawn, a row for every axis."""
    axes = data["shapes"][shape]["positions"]
    return np.array([np.frombuffer(base64.b64decode(axis), dtype="<f4") for axis in axes])
