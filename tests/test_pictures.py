"""Pictures show what the files say: looked at by their pixels, and once by a person."""

import json

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Load, Material, Run, Scene, Support, files, pictures, report
from tests.scenes import PULLED_BLOCK, box_body, slab

pytestmark = pytest.mark.serial


def write_run(scene, folder, body=None):
    prepared = Run(scene, MPI.COMM_SELF, body)
    files.write(prepared, prepared.solve(), folder)


def pixels(path):
    from matplotlib import image

    return image.imread(path)[..., :3]


def has_colour(picture, colour, tolerance=0.06):
    wanted = np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])
    return bool((np.abs(picture - wanted).max(axis=-1) < tolerance).any())


def test_report_draws_the_paper_figures(tmp_path):
    write_run(slab(300), tmp_path)
    drawn = {path.name for path in report.write_report(tmp_path)}
    assert drawn == {"contact_0.png", "deformed.png", "report.html"}
    for name in ("contact_0.png", "deformed.png"):
        picture = pixels(tmp_path / name)
        assert has_colour(picture, pictures.COLOURS["STICK"]), name
        assert has_colour(picture, pictures.COLOURS["SLIP"]), name
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    verdict = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))["verdict"]
    assert verdict in page
    assert "contact_0.png" in page and "deformed.png" in page


def test_where_nothing_slips_nothing_is_drawn_slipping(tmp_path):
    write_run(slab(100), tmp_path)
    report.write_report(tmp_path)
    for name in ("contact_0.png", "deformed.png"):
        assert not has_colour(pixels(tmp_path / name), pictures.COLOURS["SLIP"]), name


def test_three_dimensions(tmp_path):
    write_run(PULLED_BLOCK, tmp_path, box_body((4, 4, 2), comm=MPI.COMM_SELF))
    report.write_report(tmp_path)
    assert (tmp_path / "contact_0.png").stat().st_size > 10_000
    assert np.ptp(pixels(tmp_path / "deformed.png")) > 0.5


def test_fields_hold_what_the_result_says(tmp_path):
    import pyvista

    write_run(slab(300), tmp_path)
    body = pyvista.get_reader(str(tmp_path / "fields.pvd")).read().combine()
    assert set(body.point_data) >= {
        "displacement",
        "stress",
        "contact_pressure",
        "friction_traction",
        "status",
    }
    top = np.isclose(body.points[:, 1], 1)
    assert top.sum() == 33
    assert (body["contact_pressure"][top] == 300).all()
    assert (body["contact_pressure"][~top] == 0).all()
    assert sorted(body["status"][top]) == [1] * 26 + [2] * 7
    assert (body["status"][~top] == -1).all()
    stress = body["stress"].reshape(-1, 3, 3)
    # far from the sliding end: pressure above, no strain along x, so σ_x = −ν p
    left = body.points[:, 0] < 1
    assert stress[left, 1, 1] == pytest.approx(-300, abs=0.5)
    assert stress[left, 0, 0] == pytest.approx(-90, abs=0.5)
    assert np.abs(stress[:, 2, 2]).max() < 1e-9


def test_axisymmetric_stress_on_the_axis(tmp_path):
    """A cylinder pulled along its axis: σ_z = 10 everywhere, on the axis too."""
    scene = Scene(
        kinematics="axisymmetric",
        material=Material(1000, 0.3),
        support=(Support("y0", {"y": 0}),),
        load=(Load("y1", traction=(0, 10)),),
    )
    import pyvista

    write_run(scene, tmp_path, box_body((3, 3), (1, 2), comm=MPI.COMM_SELF))
    body = pyvista.get_reader(str(tmp_path / "fields.pvd")).read().combine()
    stress = body["stress"].reshape(-1, 3, 3)
    assert stress[:, 1, 1] == pytest.approx(10, rel=1e-6)
    assert np.abs(stress[:, 2, 2]).max() < 1e-4


def test_run_without_an_answer_is_not_drawn(tmp_path):
    from fenics_contact import InputError
    from tests.scenes import with_solver

    write_run(with_solver(slab(600), max_iterations=1), tmp_path)
    with pytest.raises(InputError, match="did not converge"):
        report.write_report(tmp_path)
