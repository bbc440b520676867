"""What conduction costs that is found together with the pressures: a run with it, and without."""

from __future__ import annotations

import dataclasses
from typing import Any

from cost_solves import Stopwatch

from fenics_contact import Conductance, Heat, Run, Scene, SolverSettings
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.verification.memory_check import BlockCase, pair
from fenics_contact.verification.memory_worker import body_of, scene_of

# isort: split
from mpi4py import MPI

HEAT_CASES = [pair("Q2", 40, 30), pair("Q2", 57, 44), pair("Q2", 93, 71)]
QUICK_HEAT_CASES = HEAT_CASES[1:2]
LIMIT_OF_HEAT = 2.0  # runs without heat
MOST_RUNS = 12


def with_heat(scene: Scene) -> Scene:
    """Two blocks that are hot above, cold below, and conduct by the pressure on each other."""
    (material,), (contact,) = scene.material, scene.contact
    conducts = Conductance(pressures=(0, 100), values=(0, 10))
    return dataclasses.replace(
        scene,
        material=(dataclasses.replace(material, thermal_expansion=1e-4, conductivity=1.0),),
        contact=(dataclasses.replace(contact, conductance=conducts),),
        heat=(Heat("bottom", temperature=0), Heat("top", temperature=100)),
    )


def heat_row(case: BlockCase, comm: MPI.Comm, enough: float) -> dict[str, float]:
    """Time runs with and without heat by turns, as a user starts them; collective.

    Args:
        case: Two bodies.
        comm: The ranks.
        enough: Seconds after which two runs of each are enough.

    Returns:
        The least seconds of both, and how many times one takes the other.
    """
    cold = dataclasses.replace(scene_of(case, "condensed"), solver=SolverSettings(errors="none"))
    few = body_of(case.few_cells, comm)
    for scene in (cold, with_heat(cold)):  # so that nothing is left to compile or load
        _seconds(scene, few)
    body, spent = body_of(case, comm), 0.0
    least = {"run": float("inf"), "heat_run": float("inf")}
    for number in range(MOST_RUNS):
        if number > 1 and spent > enough:
            break
        for name, scene in (("run", cold), ("heat_run", with_heat(cold))):
            seconds = _seconds(scene, body)
            least[name] = min(least[name], seconds)
            spent += seconds
    found = {f"{name}_seconds": seconds for name, seconds in least.items()}
    return {**found, "heat_ratio": least["heat_run"] / least["run"]}


def _seconds(scene: Scene, body: Body) -> float:
    """Seconds of a run from its problem to its results; collective."""
    watch = Stopwatch(body.mesh.comm)
    found: Any = Run(scene, body.mesh.comm, body).solve()
    if not found.passed:
        raise RuntimeError(found.verdict)
    return watch.seconds()
