"""A condensed body in a file: read on any number of ranks, and not factorised again."""

import shutil

import pytest
from mpi4py import MPI

from fenics_contact import Material, Study
from fenics_contact.common.parallel import on_root
from fenics_contact.simulation.studies import saved_body
from tests.messages import refused
from tests.scenes import box_body, slab
from tests.simulation.studies.cases import BALL, CASES, ON_A_FLOOR, square
from tests.simulation.studies.test_study import require_same

COMM = MPI.COMM_WORLD


def ball():
    return box_body((6, 6), (1, 1))


@pytest.mark.parametrize("name", ["half-space", "two bodies"])
def test_answers_of_a_body_from_a_file(name, folder):
    scene, make, every = CASES[name]
    body = make()
    first = Study(scene, COMM, body)
    expected = first.solve(every[0])
    first.save(folder / "body.npz")
    study = Study.load(folder / "body.npz", scene, COMM, body)
    answer = study.quantities(every[0])
    if COMM.size == 1 and name == "half-space":  # bodies that slid are paired by their displacement
        assert study.factorisations == 0
    for key in ("contact_area", "max_contact_pressure", "normal_force"):
        assert answer.quantities[key] == pytest.approx(expected.quantities[key], rel=1e-8)
    require_same(study.solve(every[0]), expected)  # the fields need the factor
    assert study.factorisations == 1


def test_the_scene_is_in_the_file(folder):
    study = Study(slab())
    expected = study.solve()
    study.save(folder / "slab.npz")
    require_same(Study.load(folder / "slab.npz").solve(), expected)


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """A file of a body, and the scene's own; in a folder that all ranks know."""
    folder = on_root(COMM, lambda: tmp_path_factory.mktemp("saved"))
    study = Study(ON_A_FLOOR, COMM, square())
    study.quantities()
    study.save(folder / "body.npz")
    yield folder / "body.npz"
    on_root(COMM, lambda: shutil.rmtree(folder))


def softer(scene):
    return Study(scene).changed({"material": (Material(500, 0.3),)})


def test_another_body_is_refused(saved):
    with refused("saved_body_of_other_material"):
        Study.load(saved, softer(ON_A_FLOOR), COMM, square())
    with refused("saved_body_of_other_mesh"):
        Study.load(saved, ON_A_FLOOR, COMM, box_body((5, 4), (1, 1)))


def test_a_file_that_is_none_is_refused(saved, folder):
    with refused("no_saved_body"):
        Study.load(folder / "nothing.npz", ON_A_FLOOR, COMM, square())

    def damage():
        content = bytearray(saved.read_bytes())
        content[len(content) // 2] ^= 1
        (folder / "damaged.npz").write_bytes(content)

    on_root(COMM, damage)
    with refused("saved_body_damaged"):
        Study.load(folder / "damaged.npz", ON_A_FLOOR, COMM, square())


def test_another_format_is_refused(saved, monkeypatch):
    monkeypatch.setattr(saved_body, "_FORMAT", 4)
    with refused("saved_body_of_another_format"):
        Study.load(saved, ON_A_FLOOR, COMM, square())


def test_a_scene_that_no_file_can_have_is_asked_for(saved):
    with refused("saved_body_without_scene"):
        Study.load(saved)


def test_nothing_is_saved_before_there_is_anything(folder):
    with refused("saved_body_before_solve"):
        Study(BALL, COMM, ball()).save(folder / "body.npz")
