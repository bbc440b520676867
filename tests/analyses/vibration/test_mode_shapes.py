"""Pictures of mode shapes: from the files of a run, which hold the shapes themselves."""

import dataclasses

import numpy as np
import pytest

from fenics_contact import (
    Contact,
    Discretisation,
    Material,
    Modes,
    Obstacle,
    Run,
    Scene,
    SolverSettings,
    Stability,
    Support,
)
from fenics_contact.analyses.stability.page import draw_squeal_shapes
from fenics_contact.analyses.vibration.page import draw_mode_film, draw_mode_shapes
from fenics_contact.report.drawing.fields import read_modes
from fenics_contact.report.drawing.figures import style
from fenics_contact.simulation.output.run_folder import write
from fenics_contact.verification.published.sliding import sliding_block
from tests.scenes import box_body

pytest.importorskip("pyvista")
FREE = Scene(
    kinematics="plane strain",
    material=Material(100.0, 0.0, density=1.0),
    discretisation=Discretisation(1),
    support=(Support("x0", {"x": 0, "y": 0}),),
    contact=(Contact("x1", obstacle=Obstacle("plane", position=(3.0, 0.0), normal=(-1.0, 0.0))),),
    modes=Modes(3),
    solver=SolverSettings(errors="none"),
)


def solved(scene, body, folder):
    run = Run(scene, body=body)
    result = run.solve()
    write(run, result, folder)
    assert len(result.modes) == scene.modes.number
    return run, result.record("")


@pytest.mark.parametrize("kinematics", ["plane strain", "3D"])
def test_each_mode_has_a_panel(kinematics, folder):
    space = kinematics == "3D"
    support = Support("x0", dict.fromkeys("xyz" if space else "xy", 0))
    obstacle = Obstacle("plane", position=(3.0, 0.0, 0.0), normal=(-1.0, 0.0, 0.0))
    contact = (Contact("x1", obstacle=obstacle),) if space else FREE.contact
    scene = dataclasses.replace(FREE, kinematics=kinematics, support=(support,), contact=contact)
    sizes = (8, 2, 2) if space else (8, 2)
    run, record = solved(scene, box_body(sizes, (2.0, 0.5, 0.5)), folder)
    if run.problem.comm.rank > 0:
        return
    shapes = list(read_modes(folder))
    assert len(shapes) == 3
    # As their modal masses say.
    for shape, mode in zip(shapes, record.modes, strict=True):
        largest = np.linalg.norm(np.asarray(shape["displacement"]), axis=1).max()
        assert largest == pytest.approx(1.0, rel=1e-6), mode
    with style():
        (picture,) = draw_mode_shapes(folder, record)
    assert picture.path.stat().st_size > 10_000
    assert "Coloured by the size of the displacement" in picture.caption


def test_a_run_without_modes_has_no_picture(folder):
    run = Run(dataclasses.replace(FREE, modes=None), body=box_body((4, 2), (2.0, 0.5)))
    result = run.solve()
    write(run, result, folder)
    if run.problem.comm.rank == 0:
        assert draw_mode_shapes(folder, result.record("")) == []


def test_what_grows_while_it_slides_has_two_moments(folder):
    """At each point of a contact the displacement stays along it, as the obstacle holds it."""
    scene, body = sliding_block(3, Stability(number=5))
    run = Run(scene, body=body)
    result = run.solve()
    write(run, result, folder)
    if run.problem.comm.rank > 0:
        return
    growing = [mode for mode in result.stability.modes if mode.grows]
    assert len(growing) == 1
    shape = list(read_modes(folder, "squeal"))[growing[0].number - 1]
    below = np.asarray(shape.points)[:, 1] < 1e-9
    for name in ("displacement", "displacement_quarter_later"):
        moved = np.abs(np.asarray(shape[name])[below])
        assert moved[:, 0].max() > 0.1 and moved[:, 1].max() < 1e-3
    with style():
        (picture,) = draw_squeal_shapes(folder, result.record(""))
    assert picture.path.name == "squeal.png" and picture.path.stat().st_size > 10_000
    steady = dataclasses.replace(result.stability, modes=[])
    assert not draw_squeal_shapes(folder, dataclasses.replace(result, stability=steady).record(""))


def test_flat_modes_swing_in_a_film(folder):
    """There and back: halfway all is at rest, and the two ends are each other's mirror image."""
    scene = dataclasses.replace(FREE, modes=Modes(1))
    run, record = solved(scene, box_body((8, 2), (2.0, 0.5)), folder)
    if run.problem.comm.rank > 0:
        return
    with style():
        (film,) = draw_mode_film(folder, record)
    assert film.path.name == "animation_modes.gif"
    image = pytest.importorskip("PIL.Image").open(film.path)
    frames = []
    for number in range(image.n_frames):
        image.seek(number)
        frames.append(np.asarray(image.convert("L"), dtype=float))
    count = len(frames)
    assert count == 24 and {frame.shape for frame in frames} == {frames[0].shape}
    assert np.abs(frames[5] - frames[count - 5]).mean() < 1  # the way back is the way there
    moved = [np.abs(frame - frames[count // 4]).mean() for frame in frames]
    assert min(moved[0], moved[count // 2]) > 5 * moved[3 * count // 4]
