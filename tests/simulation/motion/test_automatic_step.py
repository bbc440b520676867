"""The time step that a motion leaves to the program, against the speeds of waves."""

import dataclasses

import numpy as np
import pytest
from dolfinx.mesh import CellType

from fenics_contact import (
    Discretisation,
    Material,
    Motion,
    Run,
    Scene,
    load_scene,
)
from fenics_contact.common.parallel import on_root
from fenics_contact.simulation.output import run_folder as files
from tests.messages import refused
from tests.scenes import box_body

E, NU, RHO = 1000.0, 0.3, 2.0
MOTION = Motion(step="automatic", end=1)
# Speeds of pressure waves (A. E. H. Love, Mathematical Theory of Elasticity, 204).
IN_SPACE = np.sqrt(E * (1 - NU) / ((1 + NU) * (1 - 2 * NU) * RHO))
IN_A_PLATE = np.sqrt(E / (1 - NU**2) / RHO)


def flying(kinematics="plane strain", material=None, degree=1, motion=MOTION):
    return Scene(
        kinematics=kinematics,
        material=(material or Material(E, NU, density=RHO),),
        discretisation=Discretisation(degree),
        motion=motion,
    )


def step_of(scene, cells=(10, 10)):
    prepared = Run(scene, body=box_body(cells, (1, 1, 1), cell_of(scene)))
    assert prepared.scene.motion.size == prepared.model.time_step
    return prepared.scene.motion.step


def cell_of(scene):
    return CellType.hexahedron if scene.kinematics == "3D" else CellType.quadrilateral


def two_digits(value):
    """Rounded down."""
    unit = 10.0 ** (np.floor(np.log10(value)) - 1)
    return np.floor(value / unit) * unit


@pytest.mark.parametrize(
    ("kinematics", "speed", "cells"),
    [
        ("plane strain", IN_SPACE, (10, 10)),
        ("plane stress", IN_A_PLATE, (10, 10)),
        ("axisymmetric", IN_SPACE, (10, 10)),
        ("3D", IN_SPACE, (10, 10, 10)),
    ],
)
@pytest.mark.parametrize("degree", [1, 2])
def test_a_pressure_wave_passes_a_cell_from_node_to_node(kinematics, speed, cells, degree):
    expected = two_digits(0.1 / speed / degree)
    assert step_of(flying(kinematics, degree=degree), cells) == pytest.approx(expected)


def test_of_a_material_that_is_stiffer_along_an_axis_that_speed_counts():
    stiffness = np.diag([400.0, 100.0, 100.0, 40.0, 40.0, 40.0])
    material = Material(stiffness=stiffness, density=RHO)
    expected = two_digits(0.1 / np.sqrt(400 / RHO))
    assert step_of(flying(material=material)) == pytest.approx(expected)


def test_cells_of_most_of_the_volume_count():
    """Of those with x > .5 half are stretched to three times the size, the others made small."""
    body = box_body((10, 10), (1, 1))
    x = body.mesh.geometry.x
    x[:, 0] = np.where(x[:, 0] > 0.5, 0.5 + 9 * (x[:, 0] - 0.5), x[:, 0])
    prepared = Run(flying(), body=body)
    assert prepared.scene.motion.step == pytest.approx(two_digits(0.3 / IN_SPACE))


def test_a_run_is_that_of_the_number_and_files_say_it(folder):
    scene = flying(motion=dataclasses.replace(MOTION, end=0.05, velocity={"body": (1, 2)}))
    prepared = Run(scene, body=box_body((4, 4)))
    found = files.solve_and_write(prepared, folder)
    step = prepared.scene.motion.step
    assert found.passed and len(found.steps) == np.ceil(0.05 / step * (1 - 1e-9))
    given = dataclasses.replace(scene, motion=dataclasses.replace(scene.motion, step=step))
    same = Run(given, body=box_body((4, 4))).solve()
    assert found.quantities["momentum"] == same.quantities["momentum"]
    on_root(prepared.problem.comm, lambda: said_in(folder, found.model.time_step))


def said_in(folder, step):
    assert f'"time_step": {step!r}' in (folder / "result.json").read_text(encoding="utf-8")


def test_it_is_written_and_read(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text(
        'kinematics = "plane strain"\nmesh.file = "a.msh"\n[material]\nyoungs_modulus = 1\n'
        'poissons_ratio = 0.3\ndensity = 1\n[motion]\nstep = "automatic"\nend = 2\n',
        encoding="utf-8",
    )
    motion = load_scene(file).motion
    assert motion == Motion(step="automatic", end=2)
    assert motion.steps.several and motion.steps.last == 2
    with refused("motion_step_is_auto"):
        load_scene(file, ["motion.step='auto'"])


def test_too_many_steps_are_refused_with_their_length():
    scene = flying(motion=Motion(step="automatic", end=1e4))
    with refused("motion_needs_too_many_steps"):
        step_of(scene)
