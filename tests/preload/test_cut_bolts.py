"""Bolts of a CAD file that are cut for their preload: bars of ν = 0, by the joint diagram.

Between the ground and a rigid head, glued on top, stand two bolts of a section of 1 and a height of
5, and between them a sleeve of 1.5 × 1 × 4 with a washer of a height of 1 on it.
"""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    Material,
    MeshSource,
    Obstacle,
    Path,
    Preload,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Support,
)
from fenics_contact.mesh.loading import load_body
from tests import cad

COMM = MPI.COMM_WORLD
E_BOLT, E_SLEEVE, PENALTY, GLUE = 1000.0, 400.0, 5e-6, 1e-6
PLACES = {"left": (0, 0, 1, 5), "sleeve": (1.5, 0, 1.5, 4), "washer": (1.5, 4, 1.5, 1)}
PLACES |= {"right": (3.5, 0, 1, 5)}
BOLT = 1 / (5 / E_BOLT + GLUE)  # stiffness of each
PARTS = 1.5 / (5 / E_SLEEVE + PENALTY + GLUE)
FORCES = (6.0, 4.0)


@pytest.fixture(scope="module", params=[2, 3])
def source(request, tmp_path_factory):
    """The file, and its lower and upper ends by the numbers of their surfaces."""
    dimension = request.param

    def build(occ):
        for x, y, wide, high in PLACES.values():
            if dimension == 2:
                occ.addRectangle(x, y, 0, wide, high)
            else:
                occ.addBox(x, y, 0, wide, high, 1)

    folder = COMM.bcast(tmp_path_factory.mktemp("bolts"))
    file = cad.write_shapes(folder / "bolts.brep", build)
    found = MeshSource(file, size=1.0)
    numbers = load_body(found, dimension, COMM).numbers
    depth = (0.5,) if dimension == 3 else (0.0,)
    places = {number: group.centre for number, group in numbers.items() if not group.places}

    def at(part, top):
        x, y, wide, high = PLACES[part]
        wanted = (x + wide / 2, y + high * top, *depth)
        there = [int(n) for n, c in places.items() if np.allclose(c, wanted, atol=1e-5)]
        return max(there) if part == "washer" else min(there)  # its lower side is the second

    groups = {
        "ground": tuple(at(part, 0) for part in ("left", "sleeve", "right")),
        "top": tuple(at(part, 1) for part in ("left", "washer", "right")),
        "seat": (at("sleeve", 1),),
        "under_washer": (at("washer", 0),),
    }
    return dimension, dataclasses.replace(found, groups=groups)


def solved(source, solver, pulled=0.0, times=(1.0, 1.5, 2.0), **preload):
    """Both bolts tightened by time 1, the head pulled by time 2."""
    dimension, mesh = source
    axes = "xyz"[:dimension]
    head = Obstacle(force=pulled, path=Path(time=(1, 2), factor=(0, -1)))
    bolts = tuple(
        Preload(
            **{"on": on, "axis": (0, 1, 0)[:dimension], "force": force, "name": name}
            | {"between": (1, 3)}
            | preload
        )
        for on, force, name in zip(("body_1", "body_4"), FORCES, ("left", "right"), strict=True)
    )
    moduli = (E_BOLT, E_SLEEVE, E_SLEEVE, E_BOLT)
    scene = Scene(
        kinematics="plane strain" if dimension == 2 else "3D",
        mesh=(mesh,),
        material=tuple(
            Material(modulus, 0.0, on=f"body_{n}") for n, modulus in enumerate(moduli, 1)
        ),
        discretisation=Discretisation(1),
        support=(Support("ground", dict.fromkeys(axes, 0)),),
        contact=(
            Contact("top", contact="bonded", obstacle=head, penalty_parameter=GLUE),
            Contact("seat", against="under_washer", penalty_parameter=PENALTY),
        ),
        preload=bolts,
        steps=Steps(times=times),
        solver=SolverSettings(solver=solver, errors="none"),
    )
    result = Run(scene).solve()
    assert result.passed, result.verdict
    return result


def forces(result):
    return [[bolt.force for bolt in step.preloads.values()] for step in result.steps]


SOLVERS = ["condensed", "full", "iterative"]


@pytest.mark.parametrize("solver", SOLVERS)
def test_joint_diagram(source, solver):
    """Each bolt takes k_b/(2 k_b + k_p) of the pull; beyond separation half of what is more."""
    if solver == "iterative" and source[0] == 2:
        pytest.skip("it is for 3D models")
    share = BOLT / (2 * BOLT + PARTS)
    separation = sum(FORCES) / (1 - 2 * share)
    pulled = 1.5 * separation  # .75 of it in the step before
    result = solved(source, solver, pulled, locked_from=1.0)
    found = forces(result)
    assert found[0] == pytest.approx(FORCES, rel=1e-6)
    for step, row, part in zip(result.steps[1:], found[1:], (0.5, 1.0), strict=True):
        pull = part * pulled
        below, above = min(pull, separation), max(pull - separation, 0.0)
        expected = [force + share * below + 0.5 * above for force in FORCES]
        assert row == pytest.approx(expected, rel=1e-6)
        pressed = step.contacts[1].quantities["normal_force"]
        left = max(sum(FORCES) - (1 - 2 * share) * pull, 0.0)
        assert pressed == pytest.approx(left, rel=1e-5, abs=1e-8)


@pytest.mark.parametrize("solver", SOLVERS)
def test_released(source, solver):
    """The work comes back, and the parts touch without force."""
    if solver == "iterative" and source[0] == 2:
        pytest.skip("it is for 3D models")
    path = Path(time=(0, 1, 2), factor=(0, 1, 0))
    result = solved(source, solver, times=(1.0, 2.0), path=path)
    assert forces(result)[0] == pytest.approx(FORCES, rel=1e-6)
    assert forces(result)[1] == pytest.approx((0, 0), abs=1e-7)
    before = result.steps[0].quantities
    compliance = [1 / BOLT * force**2 for force in FORCES] + [sum(FORCES) ** 2 / PARTS]
    assert before["external_work"] == pytest.approx(0.5 * sum(compliance), rel=1e-6)
    assert abs(result.quantities["external_work"]) < 1e-8 * before["external_work"]


def test_two_in_one_body(folder):
    """A stud through a flange, tightened on one side and then on the other."""

    def build(occ):
        stud = occ.addRectangle(0, 0, 0, 1, 10)
        occ.fuse([(2, stud)], [(2, occ.addRectangle(-1, 4.5, 0, 3, 1))])

    file = cad.write_shapes(folder / "stud.brep", build)
    mesh = MeshSource(file, size=0.5)
    numbers = load_body(mesh, 2, COMM).numbers
    centres = {n: group.centre[:2] for n, group in numbers.items() if not group.places}
    places = {"foot": (0.5, 0), "end": (0.5, 10), "left": (-1, 5), "right": (2, 5)}
    groups = {
        name: tuple(int(n) for n, c in centres.items() if np.allclose(c, place, atol=1e-5))
        for name, place in places.items()
    }
    paths = Path(time=(0, 1), factor=(0, 1)), Path(time=(1, 2), factor=(0, 1))
    scene = Scene(
        kinematics="plane strain",
        mesh=(dataclasses.replace(mesh, groups=groups),),
        material=Material(E_BOLT, 0.3),
        discretisation=Discretisation(1),
        support=tuple(Support(name, {"x": 0, "y": 0}) for name in groups),
        preload=(
            Preload("body", (0, 1), 6.0, paths[0], name="lower", between=(0, 3)),
            Preload("body", (0, 3), 4.0, paths[1], name="upper", between=(7, 9)),
        ),
        steps=Steps(times=(1.0, 2.0)),
        solver=SolverSettings(errors="none"),
    )
    result = Run(scene).solve()
    assert result.passed, result.verdict
    np.testing.assert_allclose(forces(result), [[6, 0], [6, 4]], rtol=1e-9, atol=1e-9)
    reactions = {support.on: support.reaction[1] for support in result.supports}
    assert reactions["foot"] == pytest.approx(-6, rel=1e-9)
    assert reactions["end"] == pytest.approx(4, rel=1e-9)
