"""What is kept of a scene that was solved: a row of plain data."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fenics_contact import Result
from fenics_contact.quantities import table
from tests.random.outcomes import Outcome
from tests.random.scenes import RandomScene

# What the automatic penalty leaves differs from mesh to mesh.
_OF_THE_PENALTY = {"max_penetration", "penalty_energy"}
_COMPARED = {
    *(set(table.with_true_value()) - _OF_THE_PENALTY),
    *("contact_force", "pressure_integral", "contact_radius", "stick_radius"),
}


def row_of(random: RandomScene, outcome: Outcome) -> dict[str, Any]:
    """Of one solve; global numbers, the same on every rank.

    Args:
        random: The scene.
        outcome: What became of it.
    """
    scene, result = random.scene, outcome.result
    row: dict[str, Any] = {
        "kind": random.kind,
        "kinematics": scene.kinematics,
        "cell": f"{random.cell} degree {scene.discretisation.degree} order {random.order}",
        "must_be": random.must_be,
        "known": [[known.name, known.value, known.size] for known in random.known],
        "code": outcome.code,
        "punch": any(c.obstacle and "punch" in (c.obstacle.shape or "") for c in scene.contact),
        "finite": outcome.finite,
        "slips_and_sticks": outcome.mixed,
        "seconds": outcome.seconds,
        "words": outcome.words,
        "faults": list(outcome.balance.faults),
        "quantities": {},
    }
    if result is None:
        return row | {"solver": scene.solver.solver, "checks": {}}
    checks = {name: check.value / check.limit for name, check in result.checks.items()}
    return row | {
        "solver": result.model["solver"],
        "dofs": result.model["dofs"],
        "checks": checks,
        "quantities": quantities_of(result),
        "sizes": sizes_of(result) | outcome.balance.sizes,
        "edges": has_edges(result),
        "notes": list(result.error_notes),
    }


def quantities_of(result: Result) -> dict[str, list[Any]]:
    """Name → values, and the bar (None where there is none).

    Of several contacts or supports each has its own, ``NAME.quantity``.

    Args:
        result: Of a run.
    """
    several = len(result.contacts) > 1
    found = _with_bars("", result.quantities, result.errors)
    for contact in result.contacts if several else []:
        found |= _with_bars(f"{contact['name']}.", contact["quantities"], contact.get("errors"))
    for name, reaction, errors in _reactions(result):
        found |= _with_bars(f"{name}.", {"reaction": reaction}, errors)
    for coupling in result.couplings:
        moved = {"displacement": coupling.displacement, "rotation": coupling.rotation}
        for name, values in moved.items():
            bar = (coupling.errors.get(name) or {}).get("total")
            found |= {f"{coupling.name}.{name}": [values, bar]} if values else {}
    derived = {}
    for name, (values, bar) in found.items():
        if name.endswith("contact_force"):
            derived[name.replace("contact_force", "vertical")] = [values[-1:], bar]
        if name == "reaction":
            derived["vertical_reaction"] = [values[-1:], bar]
    return found | derived


def _reactions(result: Result) -> list[tuple[str, Any, Any]]:
    """Of the supports of each name, where there are several names."""
    named = getattr(result, "reactions", {})
    rows = [(name, of["reaction"], of.get("errors")) for name, of in named.items()]
    return rows if len(rows) > 1 else []


def _with_bars(prefix: str, quantities: Mapping[str, Any], errors: Any) -> dict[str, list[Any]]:
    """Of all quantities that are numbers."""
    found = {}
    for name, value in quantities.items():
        compared = name in _COMPARED or name.startswith("displacement_")
        if not compared or value is None:
            continue
        bar = (errors or {}).get(name)
        total = bar.get("total") if isinstance(bar, Mapping) else bar
        values = np.atleast_1d(np.asarray(value, dtype=float)).tolist()
        found[prefix + name] = [values, total]
    return found


def sizes_of(result: Result) -> dict[str, float]:
    """What small quantities are small beside: the largest force, area, energy."""
    forces, areas = [0.0], [0.0]
    for values in [support["reaction"] for support in result.supports]:
        forces.append(float(np.linalg.norm(values)))
    for contact in result.contacts:
        for name, value in contact["quantities"].items():
            if value is None:
                continue
            if name.endswith("force") or name == "pressure_integral":
                forces.append(float(np.linalg.norm(value)))
            if name.endswith("area"):
                areas.append(abs(value))
    energies = [
        abs(result.quantities.get(name) or 0.0) for name in ("strain_energy", "external_work")
    ]
    return {"force": max(forces), "area": max(areas), "energy": max(energies)}


def has_edges(result: Result) -> bool:
    """Whether a surface has points of more than one status: an edge then crosses its cells."""
    points = result.points
    if points is None:
        return False
    each = [points.status[points.of(number)] for number in range(len(result.contacts))]
    return any(len(set(status.tolist())) > 1 for status in each)
