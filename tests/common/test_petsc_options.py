"""PETSc's options that a user gives: they win, they leave, and unused ones are named."""

import pytest
from mpi4py import MPI
from petsc4py import PETSc

import fenics_contact
from fenics_contact import main
from fenics_contact.cli import program as cli
from fenics_contact.common.petsc_options import _REFUSALS, given, is_used, parse
from tests.cli.test_commands import SCENE, write
from tests.messages import refused, says
from tests.scenes import PULLED_BLOCK, box_body, with_solver

COMM = MPI.COMM_WORLD


def test_words_become_options():
    assert parse([]) == {}
    assert parse(
        ["-snes_monitor", "-ksp_rtol", "-1e-3", "--fenics_contact_bulk_pc_type", "ml"]
    ) == {
        "fenics_contact_snes_monitor": "",
        "fenics_contact_ksp_rtol": "-1e-3",
        "fenics_contact_bulk_pc_type": "ml",
    }
    assert parse(["-a", "1", "-a", "-inf"]) == {"fenics_contact_a": "-inf"}


@pytest.mark.parametrize("words", [["40"], ["-a", "1", "2"], ["-"], ["-a b"], ["-3", "4"]])
def test_malformed_words_are_refused(words):
    with refused("petsc_option_malformed"):
        parse(words)


def run(folder, capsys, *petsc, sets=()):
    """Exit code, and what rank 0 said on stdout and stderr."""
    settings = [word for setting in sets for word in ("--set", setting)]
    arguments = ["run", write(folder, SCENE), "--out", str(folder / "out"), *settings, "--quiet"]
    before = PETSc.Options().getAll()
    code = main([*arguments, "--", *petsc])
    assert PETSc.Options().getAll() == before
    return code, *COMM.bcast(tuple(capsys.readouterr()))


def test_what_the_user_gives_wins_and_is_gone_afterwards(folder, capsys):
    code, said, _ = run(folder, capsys, "-snes_max_it", "1")
    assert code == 3 and "the Newton steps allowed were used up" in " ".join(said.split())
    assert run(folder, capsys) == (0, "", "")


@pytest.mark.parametrize("solver", ["condensed", "full"])
def test_every_direct_solver_takes_them(folder, capsys, solver):
    """MUMPS may not have less workspace than it foresees."""
    sets = [f"solver.solver={solver}"]
    code, _, said = run(folder, capsys, "-mat_mumps_icntl_14", "-99", sets=sets)
    assert code == 5
    says("workspace_too_small", said)
    assert run(folder, capsys, "-mat_mumps_icntl_14", "80", sets=sets) == (0, "", "")


def test_unused_ones_are_named_once(folder, capsys):
    code, _, said = run(folder, capsys, "-snes_montor", "-bulk_pc_type", "ml", "-snes_max_it", "9")
    assert code == 0
    says("petsc_options_unused", said)
    assert said.count("\n") == 1


def test_values_that_petsc_refuses_are_bad_input(folder, capsys):
    code, _, said = run(folder, capsys, "-ksp_type", "nonsense")
    assert code == 2 and said.count("\n") == 1
    says("petsc_refused", said, options="-ksp_type nonsense")
    code, _, said = run(folder, capsys, "-snes_monitor", "4", "5")
    assert code == 2
    says("petsc_option_malformed", said)


@pytest.mark.parametrize("solver", ["condensed", "full"])
def test_values_that_are_read_late_are_bad_input_too(folder, capsys, solver):
    """MUMPS reads its options as it begins to factorise."""
    sets = [f"solver.solver={solver}"]
    code, _, said = run(folder, capsys, "-mat_mumps_icntl_14", "abc", sets=sets)
    assert code == 2 and said.count("\n") == 1
    says("petsc_refused", said, options="-mat_mumps_icntl_14 abc")


@pytest.mark.parametrize("name", ["ksp_type", "pc_factor_mat_solver_type"])
def test_a_package_or_method_that_is_not_there_is_bad_input(folder, capsys, name):
    code, _, said = run(folder, capsys, f"-{name}", "foo", sets=["solver.solver=full"])
    assert code == 2
    says("petsc_refused", said, options=f"-{name} foo")


def test_those_of_the_environment_are_refused_likewise(folder, capsys):
    """PETSc puts ``PETSC_OPTIONS`` into its database as it starts."""
    PETSc.Options().setValue("fenics_contact_ksp_type", "foo")
    try:
        code, _, said = run(folder, capsys, "-snes_max_it", "9")
    finally:
        PETSc.Options().delValue("fenics_contact_ksp_type")
    assert code == 2 and said.count("\n") == 1
    says("petsc_refused", said, options="-ksp_type foo -snes_max_it 9")


def test_other_errors_of_petsc_are_not_blamed_on_options():
    """Sizes that do not fit are a fault of the program, whatever options there are."""
    square = PETSc.Mat().createAIJ((2, 2), comm=MPI.COMM_SELF)
    square.assemble()
    short, long = (PETSc.Vec().createSeq(size, comm=MPI.COMM_SELF) for size in (2, 3))
    with pytest.raises(PETSc.Error) as raised, given({"fenics_contact_snes_max_it": "9"}, COMM):
        square.mult(long, short)
    assert raised.value.ierr in _REFUSALS


def test_the_iterative_solver_takes_them(folder):
    """Of multigrid, and of MUMPS in the cells at the contacts."""

    scene, body = with_solver(PULLED_BLOCK, solver="iterative"), box_body((3, 3, 3))
    options = parse(["-bulk_mg_levels_ksp_max_it", "3", "-zone_mat_mumps_icntl_14", "90"])
    with given(options, COMM):
        assert fenics_contact.run(scene, COMM, body).passed
        assert all(is_used(name) for name in options)


@pytest.mark.serial
def test_a_monitor_prints(folder, capfd):
    assert (
        main(["run", write(folder, SCENE), "--out", str(folder / "out"), "--", "-snes_monitor"])
        == 0
    )
    assert "SNES Function norm" in capfd.readouterr().out


def test_values_of_before_come_back():
    name = "fenics_contact_snes_max_it"
    PETSc.Options().setValue(name, 7)
    try:
        with given({name: "3"}, COMM):
            assert PETSc.Options().getInt(name) == 3
        assert PETSc.Options().getInt(name) == 7
    finally:
        PETSc.Options().delValue(name)


def test_scripts_take_them(folder, capsys):
    from demos.demo_slab import scene

    words = ["--out", str(folder / "out"), "--no-pictures", "--quiet", "--", "-snes_max_it", "1"]
    assert cli.run_script(scene, "unused", arguments=words) == 3
