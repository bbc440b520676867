"""Run a scene: on one mesh, or on mesh after mesh where it asks for an accuracy."""

from __future__ import annotations

from mpi4py import MPI

from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.adaptive.levels import AdaptiveRun
from fenics_contact.simulation.adaptive.next_mesh import first_run
from fenics_contact.simulation.scene_run import Run


def run(scene: Scene, comm: MPI.Comm = MPI.COMM_WORLD, body: Body | None = None) -> Result:
    """Solve a scene; collective.

    Args:
        scene: What to solve; one that asks for an accuracy, mesh after mesh.
        comm: Communicator.
        body: The mesh, if not the one the scene names.

    Returns:
        Global numbers, the same on every rank and any number of ranks.

    Raises:
        InputError: The scene or its mesh cannot be used; of it, ``NoEquilibriumError``: supports
            and friction cannot hold the loads (paper, (2.4)).
        MachineError: The machine has not the memory, or a file could not be written.

    That Newton's method fails is no error, but a result that says so. What goes wrong on one rank
    alone ends all ranks, with a message and ``MPI_Abort``.

    A sphere on a half-space, with Hertz's force 4/3 E* √R d^(3/2) (K. L. Johnson, Contact
    Mechanics, 1985, (4.23)):

    >>> from fenics_contact import load_scene, main
    >>> main(["new", "hertz", "--quiet"])  # writes hertz.toml and hertz.geo
    0
    >>> result = run(load_scene("hertz.toml"))
    >>> exact = 4 / 3 * 1000 / (1 - 0.3**2) * 8**0.5
    >>> abs(result.quantities["normal_force"] / exact - 1) < 0.01
    True
    >>> result.passed, result.exit_code
    (True, 0)

    Each contact point stands for a piece of the surface, in axisymmetric models for a ring:

    >>> points = result.points
    >>> force = float(points.weights @ points.contact_pressure)
    >>> abs(force / exact - 1) < 0.01
    True
    """
    return run_with_fields(scene, comm, body)[0]


def run_with_fields(
    scene: Scene, comm: MPI.Comm = MPI.COMM_WORLD, body: Body | None = None
) -> tuple[Result, Run]:
    """Run a scene, and return the run too, whose ``fields`` are functions of dolfinx; collective.

    Args:
        scene: What to solve.
        comm: Communicator.
        body: The mesh, if not the one the scene names.

    Returns:
        The result and its run: if the scene asks for an accuracy, that on the last mesh.

    Raises:
        InputError: As ``run``.
        MachineError: As ``run``.
    """
    prepared = first_run(scene, comm, body)
    if scene.accuracy is None:
        return prepared.solve(), prepared
    levels = AdaptiveRun(prepared, body is not None)
    result = levels.solve(lambda level, guess: level.solve(guess=guess))
    return result, levels.run
