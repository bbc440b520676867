"""Derivatives of the table's scenes beside central differences of whole runs."""

import dataclasses

import numpy as np

from fenics_contact import Study
from fenics_contact.simulation.sensitivities.scene_values import found_in, with_changes
from tests.simulation.sensitivities.scenes import TABLE

# Of a run's quantities: what Newton's method leaves of forces.
ROUND_OFF = 1e-11


def study_of(name):
    """Of a scene of the table with its automatic parameters given as they are chosen."""
    scene, body = TABLE[name].scene, TABLE[name].make()
    solver = dataclasses.replace(scene.solver, errors="none", tolerance=1e-13)
    scene = dataclasses.replace(scene, solver=solver)
    study = Study(scene, body=body)
    given = {}
    for number, contact in enumerate(study.solve().contacts):
        for key in ("penalty_parameter", "regularisation_parameter"):
            used = contact.parameters.get(key)
            if used and found_in(scene, f"contact.{number}.{key}") == "auto":
                given[f"contact.{number}.{key}"] = used
    study.scene = with_changes(scene, given)
    return study


def value_of(result, name):
    """A quantity of a result by its name."""
    owner, _, quantity = name.rpartition(".")
    axis = "xyz".find(quantity[-1]) if quantity[-2:] in ("_x", "_y", "_z") else None
    quantity = quantity if axis is None else quantity[:-2]
    found = dict(result.quantities)
    for contact in result.contacts:
        found |= contact.quantities if contact.name == owner else {}
    for support in result.supports:
        found |= {"reaction": support.reaction} if support.name == owner else {}
    if owner in result.preloads:
        found = vars(result.preloads[owner])
    return found[quantity] if axis is None else found[quantity][axis]


def differences(study, of, key, share=3e-4):
    """Central differences of whole runs; and what their round-off may be."""
    number = found_in(study.scene, key)
    step = share * (abs(number) or 1.0)
    ends = [study.solve({key: number + sign * step}) for sign in (1, -1)]
    values = np.array([[value_of(end, name) for name in of] for end in ends])
    pressed = [contact.quantities["pressure_integral"] for end in ends for contact in end.contacts]
    forces = ["force" in name or "reaction" in name for name in of]
    # Of a small force beside large ones, rounding is that of the large ones.
    sizes = np.maximum(np.abs(values).max(axis=0), np.where(forces, max(pressed), 0.0))
    return (values[0] - values[1]) / (2 * step), ROUND_OFF * sizes / step


def errors(study, of, by):
    """Of derivatives, over 1e-6 of them, the differences' round-off or their scatter over steps."""
    found = study.derivatives(of, by)
    worst = {}
    for key in by:
        expected, noise = differences(study, of, key)
        off = np.abs(np.array([found[name][key] for name in of]) - expected)
        allowed = np.maximum(1e-6 * np.abs(expected), noise)
        if (off > allowed).any():
            scatter = 3 * np.abs(expected - differences(study, of, key, 1e-4)[0])
            allowed = np.maximum(allowed, scatter)
        worst |= {(name, key): error for name, error in zip(of, off / allowed, strict=True)}
    return worst
