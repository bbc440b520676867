"""Forces of contacts: on the body of `on`, along one axis, whichever surface is the slave."""

import dataclasses
from itertools import product

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    HalfSpace,
    Load,
    Material,
    MeshSource,
    Obstacle,
    Path,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Support,
    run,
)
from fenics_contact.analytic import contact as formulas
from fenics_contact.cli.summary import print_result
from fenics_contact.quantities import table
from fenics_contact.report.load_steps import draw_forces
from fenics_contact.report.page.tables import quantities_table
from fenics_contact.results.load_history import History
from fenics_contact.scene.values import Profile
from fenics_contact.simulation.output.tables import row_of
from fenics_contact.verification.boxes import Box, boxes
from tests.scenes import ROOT, box_body

COMM = MPI.COMM_WORLD
SILENT = SolverSettings(errors="none")
CHOICES = list(product(["on", "against"], repeat=2))
# What stands on it covers half of the lowest block: as the slave, it has points beyond the other.
STACK = (
    Box("lower", (-0.5, -1), (1.5, 0), (8, 5)),
    Box("middle", (0, 0), (1, 1), (4, 3)),
    Box("top", (0, 1), (1, 2), (5, 4)),
)


def stack(slaves, turned=False, **changes):
    """Three blocks, the lowest clamped, the highest loaded across and along."""
    pairs = [("middle.y0", "lower.y1"), ("top.y0", "middle.y1")]
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("lower.y0", {"x": 0, "y": 0}),),
        load=(Load("top.y1", traction=(0.1, -1.0)),),
        contact=tuple(
            Contact(on, against=against, slave=slave, friction_coefficient=0.5)
            for pair, slave in zip(pairs, slaves, strict=True)
            for on, against in [pair[::-1] if turned else pair]
        ),
        solver=SILENT,
    )
    return dataclasses.replace(scene, **changes)


def quantities(result, number=0):
    return result.contacts[number]["quantities"]


@pytest.mark.parametrize("slaves", CHOICES)
@pytest.mark.parametrize("turned", [False, True])
def test_forces_of_a_stack_are_those_on_the_body_of_on(slaves, turned):
    """By equilibrium: what is loaded above is carried below, on any choice of slave."""
    result = run(stack(slaves, turned), COMM, body=boxes(STACK))
    assert result.passed
    side = -1 if turned else 1  # the lower block of each pair is then that of `on`
    for number in range(2):
        found = quantities(result, number)
        assert found["normal_force"] == pytest.approx(1.0, rel=1e-9)
        assert found["pressure_integral"] == pytest.approx(1.0, rel=1e-9)
        assert found["friction_force"] == pytest.approx([-0.1 * side, 0.0], rel=1e-7, abs=1e-12)
        assert found["contact_force"] == pytest.approx([-0.1 * side, 1.0 * side], rel=1e-7)
    assert result.quantities["reaction"] == pytest.approx([-0.1, 1.0], rel=1e-7)
    for name in ("normal_force", "pressure_integral", "friction_force", "contact_force"):
        assert result.quantities[name] is None


@pytest.mark.parametrize("slaves", CHOICES)
def test_slip_is_of_points_that_touch(slaves):
    """All that touches sticks, so it slips by ε at the most; open points move with their body."""
    result = run(stack(slaves), COMM, body=boxes(STACK))
    moved = 0.0
    for number in range(2):
        found = quantities(result, number)
        assert found["slip_area"] == 0
        epsilon = result.contacts[number]["parameters"]["regularisation_parameter"]
        assert 0 < found["max_slip"] <= epsilon
        mine = result.points.of(number)
        moved = max(moved, np.abs(result.points.slip[mine]).max() / epsilon)
    assert result.quantities["max_slip"] == max(quantities(result, n)["max_slip"] for n in (0, 1))
    if slaves[0] == "against":
        assert moved > 10  # of the points beyond the middle block


@pytest.mark.parametrize("slave", ["on", "against"])
def test_a_block_that_slides_slips_as_far_as_it_is_moved(slave):
    """It is moved by far more than the blocks are sheared."""
    scene = stack((slave, "auto"))
    scene = dataclasses.replace(
        scene,
        contact=scene.contact[:1],
        load=(),
        support=(*scene.support, Support("middle.y1", {"x": 0.1, "y": -1e-4})),
    )
    result = run(scene, COMM, body=boxes(STACK[:2]))
    assert result.quantities["max_slip"] == pytest.approx(0.1, rel=5e-3)
    # Of a single contact the whole model has the same resultants.
    names = ("normal_force", "pressure_integral", "friction_force", "contact_force")
    assert [result.quantities[n] for n in names] == [quantities(result)[n] for n in names]
    assert result.quantities["friction_force"][0] == pytest.approx(
        -0.5 * result.quantities["normal_force"], rel=1e-6
    )
    above = [s["reaction"] for s in result.supports if s["on"] == "middle.y1"]
    assert result.quantities["contact_force"] == pytest.approx([-x for x in above[0]], rel=1e-7)


def test_nothing_that_touches_does_not_slip():
    obstacle = Obstacle(gap=0.1)
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        load=(Load("x1", traction=(5.0, 0.0)),),
        contact=(Contact("y1", obstacle=obstacle, friction_coefficient=0.3),),
        solver=SILENT,
    )
    result = run(scene, COMM, body=box_body((4, 4), (1, 1)))
    found = quantities(result)
    assert np.abs(result.points.slip).max() > 1e-3
    assert found["max_slip"] == 0
    assert found["normal_force"] == found["pressure_integral"] == 0
    assert found["contact_force"] == [0, 0]


def half_pin(slave, coefficient=0.0, load=3.0):
    """The right half of a pin in a recess that is hardly wider, loaded from above."""
    fine = {"fine": 4, "size": 0.5}
    mesh = str(ROOT / "meshes") + "/"
    pin = {"radius": 32, "contact_angle": 20, **fine}
    socket = {"radius": 32.5, "cells_outside": 5, **fine}
    return Scene(
        kinematics="plane strain",
        mesh=(
            MeshSource(f"{mesh}cylinder.geo", pin, cell="quadrilateral", order=2, name="pin"),
            MeshSource(f"{mesh}socket.geo", socket, cell="quadrilateral", order=2, name="socket"),
        ),
        material=Material(1000, 0.3),
        symmetry=("pin.axis", "socket.axis"),
        support=(Support("socket.foot", {"x": 0, "y": 0}),),
        load=(Load("pin.top", traction=(0, -load / 32)),),
        contact=(
            Contact(
                "pin.contact",
                against="socket.contact",
                slave=slave,
                friction_coefficient=coefficient,
            ),
        ),
        solver=SILENT,
    )


@pytest.mark.parametrize("slave", ["on", "against"])
def test_normal_force_of_a_curved_pair_carries_its_load(slave):
    """Not ∫ p dA, which counts pressures that act on each other; whichever is the slave."""
    result = run(half_pin(slave), COMM)
    found = quantities(result)
    assert found["normal_force"] == pytest.approx(3.0, rel=1e-7)
    assert found["contact_force"][1] == pytest.approx(3.0, rel=1e-7)
    assert found["pressure_integral"] > (1 + 1e-4) * found["normal_force"]


@pytest.mark.parametrize("slave", ["on", "against"])
def test_pressure_and_friction_of_a_curved_pair_carry_its_load(slave):
    """Friction along a curved surface carries a part of it."""
    found = quantities(run(half_pin(slave, coefficient=0.3), COMM))
    assert found["contact_force"][1] == pytest.approx(3.0, rel=1e-6)
    assert found["normal_force"] + found["friction_force"][1] == pytest.approx(3.0, rel=1e-6)


def bored(kinematics="axisymmetric"):
    """A thick cylinder with its bore pressed outwards by a shrink fit; height 1."""
    return Scene(
        kinematics=kinematics,
        material=Material(1000, 0.3),
        support=(Support("y0", {"y": 0}), Support("y1", {"y": 0})),
        contact=(Contact("x1", obstacle=Obstacle(gap=-1e-3)),),
        solver=SILENT,
    )


def test_a_wall_all_around_has_a_pressure_integral_alone():
    """A rod in a bore too narrow by δ: p = E δ / (a (1 + ν)(1 − 2ν)), in plane strain."""
    result = run(bored(), COMM, body=box_body((6, 2), (1, 1)))
    assert result.passed
    pressure = 1000 * 1e-3 / (1.3 * 0.4)
    found = quantities(result)
    assert found["normal_force"] is None
    assert found["contact_force"] == pytest.approx([0, 0], abs=1e-9)
    assert found["pressure_integral"] == pytest.approx(2 * np.pi * pressure, rel=1e-4)
    assert "contact_radius" not in found  # the wall is not about the axis


def test_what_has_no_value_is_said_in_words(tmp_path, capsys):
    result = run(bored(), COMM, body=box_body((6, 2), (1, 1)))
    print_result(dataclasses.replace(result, timings={"total": 0.0}), tmp_path)
    said = capsys.readouterr().out
    assert "none, the surface wraps around" in said
    assert "pressure integral" in said
    page = quantities_table(result, result.contacts, "Quantities", result)
    assert "<td>none, the surface wraps around</td>" in page


def test_several_contacts_have_rows_of_their_own(tmp_path, capsys):
    result = run(stack(("auto", "auto")), COMM, body=boxes(STACK))
    print_result(dataclasses.replace(result, timings={"total": 0.0}), tmp_path)
    said = capsys.readouterr().out
    for name in ("middle.y0", "top.y0"):
        assert f"normal force of {name}" in said
        assert f"friction force of {name}" in said
    assert "None" not in said
    row = row_of(result.steps[0])
    assert row["friction_force_x"] is None
    assert row["top.y0.friction_force_x"] == quantities(result, 1)["friction_force"][0]
    assert "friction_force" not in row


@pytest.mark.serial
def test_history_of_a_wall_all_around_is_of_its_pressure_integral(tmp_path):
    body = box_body((4, 2), (1, 1), comm=MPI.COMM_SELF)
    pressed = Path(time=(0, 1), factor=(0.5, 1))
    pushed = dataclasses.replace(
        bored(), load=(Load("y1", traction=(1.0, 0.0), path=pressed),), steps=Steps(3)
    )
    pushed = dataclasses.replace(pushed, support=pushed.support[:1])
    result = Run(pushed, MPI.COMM_SELF, body).solve()
    picture = draw_forces(History.of(result), result.contacts, tmp_path / "forces.png")
    assert "∫ p dA" in picture.caption


def test_every_quantity_is_explained():
    page = (ROOT / "docs" / "results.md").read_text(encoding="utf-8")
    result = run(stack(("auto", "auto")), COMM, body=boxes(STACK))
    names = {*table.with_true_value(), *quantities(result), *result.quantities}
    assert [name for name in sorted(names) if f"`{name}`" not in page] == []


@pytest.mark.parametrize("axis", [None, (0, -1)])
def test_axis_of_an_obstacle_goes_before_that_of_the_surface(axis):
    """Pressure p on a slope, given along n: ∫ p n·m over it is p times what it covers."""
    normal = {} if axis is None else {"normal": axis}
    body = boxes((Box("body", (0, 0), (1, 1), (4, 4)),))
    body.mesh.geometry.x[:, 1] *= 1 + 0.5 * body.mesh.geometry.x[:, 0]  # the top rises by .5
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("body.y0", {"x": 0, "y": 0}),),
        contact=(Contact("body.y1", obstacle=Obstacle(gap=-1e-3, **normal)),),
        solver=SILENT,
    )
    found = quantities(run(scene, COMM, body=body))
    slope = 1.0 if axis is None else 1 / np.hypot(1, 0.5)
    assert found["normal_force"] == pytest.approx(slope * found["pressure_integral"], rel=1e-9)
    assert np.hypot(*found["contact_force"]) == pytest.approx(found["pressure_integral"], rel=1e-9)


@pytest.mark.parametrize("coefficient, stick", [(0.0, 0.0), (0.6, 0.765)])
def test_radii_of_a_sphere_on_a_half_space(coefficient, stick):
    """Hertz: a = √(R d); with friction 0.6 it sticks on .765 of the radius (the paper)."""
    result = run(sphere(coefficient), COMM)
    found = result.quantities
    hertz = formulas.paraboloid(1000 / (1 - 0.3**2), 8, 1)
    if coefficient == 0:
        assert found["contact_radius"] == pytest.approx(hertz.radius, rel=5e-3)
    area = np.pi * found["contact_radius"] ** 2
    assert found["contact_area"] == pytest.approx(area, rel=1e-6)
    ratio = found["stick_radius"] / found["contact_radius"]
    assert ratio == pytest.approx(stick, abs=5e-3)
    assert found["contact_force"][1] == pytest.approx(-found["reaction"][1], rel=1e-6)


def sphere(coefficient, gap=None):
    shape = {"shape": "paraboloid", "radius": 8, "indentation": 1}
    if gap is not None:
        shape = {"gap": gap, "indentation": 1, "direction": (0, -1), "position": (0, 0)}
    return Scene(
        kinematics="axisymmetric",
        mesh=MeshSource(
            str(ROOT / "meshes" / "half_space.geo"),
            {"fine": 5, "size": 0.2, "extent": 60, "cells_outside": 16},
            cell="quadrilateral",
        ),
        material=Material(1000, 0.3),
        symmetry=("axis",),
        half_space=HalfSpace(("outer",)),
        contact=(Contact("contact", obstacle=Obstacle(**shape), friction_coefficient=coefficient),),
        solver=SILENT,
    )


def test_a_ring_that_touches_has_no_radius():
    """A gap that is smallest away from the axis: the contact does not include it."""
    gap = Profile("x", (0.0, 2.0, 4.0, 100.0), (3.0, 0.0, 3.0, 200.0))
    found = run(sphere(0.0, gap), COMM).quantities
    assert found["contact_area"] > 0
    assert found["contact_radius"] is None


def test_prescribed_pressure_pushes_along_the_mean_normal():
    """On a whole flat side, and not on both of two opposite sides together."""
    body = box_body((4, 4), (1, 1))
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("y1", pressure=2.0),),
        solver=SILENT,
    )
    found = run(scene, COMM, body=body).quantities
    assert found["normal_force"] == pytest.approx(2.0, rel=1e-9)
    assert found["contact_force"] == pytest.approx([0.0, -2.0], abs=1e-9)
    assert found["reaction"] == pytest.approx([0.0, 2.0], abs=1e-9)


def test_glue_pulls_with_a_negative_normal_force():
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.0),
        discretisation=Discretisation(1),
        load=(Load("y0", traction=(0.5, -1.0)),),
        contact=(Contact("y1", contact="bonded", obstacle=Obstacle()),),
        solver=SILENT,
    )
    found = run(scene, COMM, body=box_body((4, 4), (1, 1))).quantities
    assert found["normal_force"] == pytest.approx(-1.0, rel=1e-8)
    assert found["contact_force"] == pytest.approx([-0.5, 1.0], rel=1e-8)
    assert found["friction_force"] == pytest.approx([-0.5, 0.0], rel=1e-8, abs=1e-12)
