"""Tamaas: boundary elements of a half-space, contact by conjugate gradients with FFTs."""

from __future__ import annotations

import math
from typing import Any

from answers import Answer, cpu_seconds
from problems import HalfSpace, Problem

NAME = "Tamaas"
# Its files for Python 3.13 are those of its free-threaded build alone.
INSTALL = ("pip, older Python", ("tamaas==2.9.0", "numpy", "scipy"))
SETTINGS: dict[str, dict[str, dict[str, Any]]] = {
    "half-space": {"tolerance 1e-9": {"tolerance": 1e-9}},
}
ABOUT = (
    "Square cells of constant pressure on the surface alone, without a period (`dcfft`); the "
    "algorithm of Polonsky and Keer with a given force, to the tolerance of its examples. It makes "
    "no use of the symmetry of revolution, which fenics_contact has here, and knows half-spaces "
    "alone, so it solves one of the problems."
)


def solve(problem: Problem, level: int, setting: dict[str, Any]) -> Answer:
    """On squares of the problem's size over twice its width."""
    import numpy as np
    import tamaas as tm

    assert isinstance(problem, HalfSpace)
    tm.set_log_level(tm.LogLevel.error)
    length, size = 2 * problem.width, problem.size(level)
    count = round(length / size)
    start = cpu_seconds()
    model = tm.ModelFactory.createModel(tm.model_type.basic_2d, [length] * 2, [count] * 2)
    model.E, model.nu = problem.youngs_modulus, problem.poissons_ratio
    tm.ModelFactory.registerNonPeriodic(model, "dcfft")
    places = (np.arange(count) + 0.5) * size - problem.width
    x, y = np.meshgrid(places, places, indexing="ij")
    surface = -(x**2 + y**2) / (2 * problem.radius)
    by_force = tm.PolonskyKeerRey.pressure
    solver = tm.PolonskyKeerRey(model, surface, setting["tolerance"], by_force, by_force)
    solver.setIntegralOperator("dcfft")
    solver.solve(problem.force / length**2)
    seconds = cpu_seconds() - start
    pressure = np.asarray(model.traction)
    touching = float((pressure > 0).sum()) * size**2
    return Answer(
        version=str(tm.__version__),
        dofs=count**2,
        solve_seconds=seconds,
        newton=0,
        factorisations=0,
        values={
            "peak pressure": float(pressure.max()),
            "contact radius": math.sqrt(touching / math.pi),
        },
    )
