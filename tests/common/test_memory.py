"""Memory per rank falls with the ranks: only contact unknowns may ever be gathered."""

import dataclasses
import pickle

import dolfinx
import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Run
from fenics_contact.problem.problem import Problem
from fenics_contact.simulation.output import run_folder as files
from tests.scenes import slab

COMM = MPI.COMM_WORLD
CELLS = (64, 96)
DEGREE = 2
NODES = (DEGREE * CELLS[0] + 1) * (DEGREE * CELLS[1] + 1)
POINTS = DEGREE * CELLS[0] + 1
MESSAGES = []  # (name, bytes) of every collective call of this package


def listening(name):
    def call(self, send, *arguments, **options):
        payload = [send, *arguments, *options.values()]
        arrays = [part for part in payload if isinstance(part, np.ndarray)]
        size = sum(part.nbytes for part in arrays) if arrays else len(pickle.dumps(send))
        answer = getattr(MPI.Intracomm, name)(self, send, *arguments, **options)
        received = 0 if answer is None else len(pickle.dumps(answer))
        MESSAGES.append((name, max(size, received)))
        return answer

    return call


COLLECTIVES = ("allgather", "gather", "bcast", "allreduce", "reduce", "alltoall", "scatter")
ListeningComm = type(
    "ListeningComm",
    (MPI.Intracomm,),
    {"__module__": "mpi4py.MPI"}  # by which petsc4py knows a communicator
    | {
        name: listening(name)
        for name in (
            *COLLECTIVES,
            *(name.capitalize() for name in COLLECTIVES),
            "Allgatherv",
            "Gatherv",
            "Scatterv",
        )
    },
)


@pytest.fixture
def listened(monkeypatch):
    """The collective calls of this package on the mesh's communicator, with their sizes."""
    plain = dolfinx.mesh.Mesh.comm.fget
    monkeypatch.setattr(
        dolfinx.mesh.Mesh, "comm", property(lambda mesh: ListeningComm(plain(mesh)))
    )
    MESSAGES.clear()
    yield MESSAGES
    MESSAGES.clear()


def arrays_of(thing, seen):
    """Every array that an object of this package holds, with the path to it."""
    if id(thing) in seen:
        return
    seen[id(thing)] = thing
    if isinstance(thing, np.ndarray):
        yield thing
    elif isinstance(thing, dolfinx.fem.Function):
        yield thing.x.array
    elif isinstance(thing, dict):
        for part in thing.values():
            yield from arrays_of(part, seen)
    elif isinstance(thing, list | tuple):
        for part in thing:
            yield from arrays_of(part, seen)
    elif type(thing).__module__.startswith("fenics_contact"):
        for part in vars(thing).values():
            yield from arrays_of(part, seen)


def prepared():
    scene = slab(300, cells=CELLS, degree=DEGREE)
    parameters = {**scene.mesh[0].parameters, "height": 12}
    mesh = dataclasses.replace(scene.mesh[0], parameters=parameters)
    return Run(dataclasses.replace(scene, mesh=mesh), ListeningComm(COMM))


@pytest.mark.skipif(COMM.size == 1, reason="one rank sends itself nothing")
def test_only_the_contact_is_gathered(folder, listened):
    """Every message is of the contact's size, far below that of one number a node."""
    made = prepared()
    result = made.solve()
    files.write(made, result, folder / "out")
    assert result.passed
    assert result.model["contact_points"] == POINTS
    limit = 8 * 64 * POINTS  # rows a contact point, of up to 64 numbers: those of its tangent
    assert 3 * limit < 8 * NODES
    assert len(listened) > 100
    # Once, the stiffness between the dofs of the contact and those that ranks share goes to rank 0.
    shared = COMM.allreduce(made.problem.spaces.displacement_space.dofmap.index_map.num_ghosts)
    stiffness = 8 * (2 * POINTS + 2 * shared) ** 2 + limit
    *others, (name, size) = sorted(listened, key=lambda message: message[1])
    assert size <= COMM.size * stiffness, (name, size)
    name, size = others[-1]
    assert size <= limit, (name, size)
    # and the listener hears: the contact's rows are among the messages
    assert size > 8 * POINTS


def test_the_listener_hears_a_body_gathered(listened):
    made = prepared()
    comm, owned = made.problem.comm, made.problem.spaces.owned_nodes
    comm.allgather(made.problem.spaces.coordinates[:owned])
    assert max(size for _, size in listened) > 3 * 8 * NODES


def test_a_rank_holds_its_share():
    """Cells, nodes and all arrays of problem and solution."""
    made = prepared()
    made.solve()
    problem: Problem = made.problem
    topology = problem.body.mesh.topology.index_map(2)
    share = 1 / COMM.size
    assert topology.size_global == CELLS[0] * CELLS[1]
    assert topology.size_local + topology.num_ghosts < 1.2 * share * topology.size_global
    spaces = problem.spaces
    assert len(spaces.coordinates) < 1.2 * share * NODES
    sizes = [found.size for found in arrays_of([problem, made.solution], {})]
    held = sum(sizes)
    assert max(sizes) == spaces.coordinates.size  # three coordinates a node
    assert held < 30 * 1.2 * share * NODES, held / NODES
    assert COMM.allreduce(held) > 8 * NODES  # the walk finds what there is
