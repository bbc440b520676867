"""Which solver a problem gets, and that one without the memory for it is refused."""

import dataclasses

import pytest
from mpi4py import MPI

from fenics_contact import Contact, Load, Material, Obstacle, Scene, Steps, Support
from fenics_contact.cli.commands import guarded
from fenics_contact.common import memory
from fenics_contact.common.errors import MachineError
from fenics_contact.common.memory import free_memory_for
from fenics_contact.problem.problem import Problem
from fenics_contact.solve import solver_choice
from fenics_contact.solve.solver_choice import choose_solver, contact_unknowns, memory_estimate
from fenics_contact.verification.boxes import Box, boxes
from tests.messages import refused
from tests.scenes import box_body, with_solver

COMM = MPI.COMM_WORLD
GIGABYTE = 1e9


def block(nu=0.3, friction=0.5, steps=1):
    return Scene(
        kinematics="3D",
        material=Material(1000, nu),
        support=(Support("z0", dict.fromkeys("xyz", 0)),),
        contact=(
            Contact(
                "z1",
                friction_coefficient=friction,
                obstacle=Obstacle("plane", position=(0, 0, 0.5)),
            ),
        ),
        steps=Steps(number=steps),
    )


def made(scene, cells=(4, 4, 2)):
    return Problem.on_mesh(scene, box_body(cells))


@pytest.fixture
def small_limit(monkeypatch):
    """Bodies of more than 100 unknowns are large."""
    monkeypatch.setattr(solver_choice, "_ITERATIVE_FROM", {1: 100, 2: 100})


def with_memory(monkeypatch, size):
    monkeypatch.setattr(solver_choice, "free_memory_for", lambda comm: size)


def test_small_problems_are_condensed():
    choice = choose_solver(made(block()))
    assert choice.name == "condensed"
    assert 0 < choice.memory < GIGABYTE


def test_large_ones_in_space_are_iterated(small_limit):
    assert choose_solver(made(block())).name == "iterative"


def test_large_contacts_are_iterated(monkeypatch):
    size = contact_unknowns(made(block()))
    monkeypatch.setattr(solver_choice, "_LARGE_CONTACT", size + 1)
    assert choose_solver(made(block())).name == "condensed"
    monkeypatch.setattr(solver_choice, "_LARGE_CONTACT", size - 1)
    choice = choose_solver(made(block()))
    assert choice.name == "iterative"
    assert "so large a contact" in choice.reason
    assert choose_solver(made(block(steps=4))).name == "condensed"


@pytest.mark.parametrize("large, name", [(96, "iterative"), (1000, "condensed")])
def test_large_pairs_are_iterated(monkeypatch, large, name):
    """Surfaces of 25 and 16 nodes: 123 dofs."""
    monkeypatch.setattr(solver_choice, "_LARGE_PAIR", large)
    lower = Box("lower", (0, 0, -1), (1, 1, 0), (4, 4, 2))
    upper = Box("upper", (0, 0, 0), (1, 1, 1), (3, 3, 2))
    scene = dataclasses.replace(
        block(),
        support=(Support("lower.z0", dict.fromkeys("xyz", 0)), Support("upper.z1", {"z": -0.01})),
        contact=(Contact("upper.z0", against="lower.z1", friction_coefficient=0.5),),
    )
    problem = Problem.on_mesh(scene, boxes((lower, upper), "hexahedron"))
    assert choose_solver(problem).name == name


def test_many_steps_pay_for_a_factorisation(small_limit):
    assert choose_solver(made(block(steps=40))).name == "condensed"


def test_no_multigrid_for_a_mean_stress(small_limit):
    assert choose_solver(made(block(nu=0.499))).name == "condensed"


def test_without_contact_a_plain_solve():
    scene = dataclasses.replace(block(), contact=(), load=(Load("z1", pressure=1.0),))
    assert choose_solver(made(scene)).name == "full"


def test_what_does_not_fit_is_iterated_or_refused(monkeypatch):
    problem = made(block())
    condensed, iterative = (memory_estimate(problem, n) for n in ("condensed", "iterative"))
    assert iterative < condensed
    with_memory(monkeypatch, 0.5 * (condensed + iterative))
    assert choose_solver(problem).name == "iterative"
    with_memory(monkeypatch, 0.5 * iterative)
    with refused("memory_for_iterative", MachineError):
        choose_solver(problem)


def test_bodies_that_contact_alone_holds_are_not_iterated_on(monkeypatch):
    """Not for their memory either: multigrid may not end. The refusal does not name it."""
    lower, upper = (
        Box("lower", (0, 0, 0), (1, 1, 0.5), (5, 5, 3)),
        Box("upper", (0, 0, 0.5), (1, 1, 1), (4, 4, 3)),
    )
    scene = Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        support=(Support("lower.z0", {"x": 0, "y": 0, "z": 0}),),
        load=(Load("upper.z1", pressure=1.0),),
        contact=(Contact("upper.z0", against="lower.z1", friction_coefficient=0.3),),
    )
    problem = Problem.on_mesh(scene, boxes((lower, upper), "hexahedron"))
    needs = {name: memory_estimate(problem, name) for name in ("condensed", "iterative")}
    assert needs["iterative"] < needs["condensed"]
    with_memory(monkeypatch, 0.5 * (needs["iterative"] + needs["condensed"]))
    with pytest.raises(MachineError) as caught:
        choose_solver(problem)
    assert "'condensed' needs" in str(caught.value)
    assert "iterative" not in str(caught.value)


def test_the_scenes_own_choice_is_refused_too(monkeypatch):
    problem = made(with_solver(block(), solver="full"))
    assert choose_solver(problem).name == "full"
    with_memory(monkeypatch, 1.0)
    with refused("memory_for_full", MachineError):
        choose_solver(problem)


def test_a_refusal_names_the_solver_that_would_do(monkeypatch):
    """Which is then taken as it is named; where none fits, none is named."""
    problem = made(with_solver(block(), solver="condensed"), (8, 8, 6))
    needs = {name: memory_estimate(problem, name) for name in ("condensed", "full", "iterative")}
    assert needs["iterative"] < needs["condensed"]
    between = 0.5 * (needs["iterative"] + needs["condensed"])
    with_memory(monkeypatch, between)
    with refused("memory_for_condensed", MachineError):
        choose_solver(problem)
    assert choose_solver(made(with_solver(block(), solver="iterative"), (8, 8, 6)))
    with_memory(monkeypatch, 0.5 * min(needs.values()))
    with refused("memory_for_none", MachineError):
        choose_solver(problem)


def test_iterative_is_for_space_and_compressible_bodies():
    plane = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("y1"),),
    )
    for problem in (
        made(with_solver(block(nu=0.499), solver="iterative")),
        Problem.on_mesh(with_solver(plane, solver="iterative"), box_body((4, 4), (1, 1))),
    ):
        with refused("iterative_not_for_plane_models"):
            choose_solver(problem)


def test_refusal_says_the_machine_failed(monkeypatch, capsys):
    with_memory(monkeypatch, 1.0)
    problem = made(block())
    assert guarded(lambda: choose_solver(problem) and 0) == 5
    said = COMM.bcast(capsys.readouterr().err)
    assert "use a coarser mesh" in said
    assert "Traceback" not in said


def test_free_memory_is_that_of_the_machine():
    assert 1e6 < free_memory_for(MPI.COMM_SELF) < 1e15
    assert 1e6 < free_memory_for(COMM) < COMM.size * 1e15


@pytest.mark.parametrize(
    ("own", "folder", "limit", "used", "cache"),
    [
        ("0::/", "", "memory.max", "memory.current", "inactive_file"),
        ("0::/job/step", "job", "memory.max", "memory.current", "inactive_file"),
        (
            "4:memory:/batch\n0::/",
            "memory/batch",
            "memory.limit_in_bytes",
            "memory.usage_in_bytes",
            "total_inactive_file",
        ),
    ],
)
def test_limits_of_control_groups(tmp_path, monkeypatch, own, folder, limit, used, cache):
    """Nested or not; files that the kernel has read and keeps do not count as used."""
    group = tmp_path / "groups" / folder
    group.mkdir(parents=True)
    (group / limit).write_text("1000000\n")
    (group / used).write_text("900000\n")
    (tmp_path / "own").write_text(own + "\n")
    monkeypatch.setattr(memory, "_GROUPS", tmp_path / "groups")
    monkeypatch.setattr(memory, "_OWN", tmp_path / "own")
    assert free_memory_for(MPI.COMM_SELF) == 100000
    (group / "memory.stat").write_text(f"anon 1\n{cache} 700000\n")
    assert free_memory_for(MPI.COMM_SELF) == 800000
    (group / limit).write_text("max\n")
    assert free_memory_for(MPI.COMM_SELF) > 1e6
