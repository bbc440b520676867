"""Laws of a user's module: named by a scene, run only where the command line allows the module."""

import json
import re
import sys

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import OwnNormalLaw, Study, UserFriction, allow_laws, main, run
from fenics_contact.common.parallel import on_root
from fenics_contact.contact.laws import allowed
from tests.contact.laws.test_formula_law import BALL, law
from tests.contact.laws.test_friction_rules import sheared
from tests.contact.laws.test_normal_compliance import pressed
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
MODULE = '''
import pathlib

import ufl

from fenics_contact import UserContactEnergy, UserFriction
from fenics_contact.contact.laws.normal.spring import positive

pathlib.Path(__file__).with_suffix(".ran").touch()


class Asperities(UserContactEnergy):
    """Exponential springs, p = p0 (exp(d/h) - 1)."""

    model = "exponential asperities"

    @staticmethod
    def density(depth, jump, p0, h):
        d = positive(depth)
        return p0 * (h * (ufl.exp(d / h) - 1) - d)


class Saturated(UserFriction):
    """mu p at low pressures, mu p0 at high ones."""

    @staticmethod
    def bound(pressure, coefficient, p0):
        return coefficient * pressure / (1 + pressure / p0)


class Helper:
    pass
'''
SCENE = """
material = {{ youngs_modulus = 1000, poissons_ratio = 0.3 }}
kinematics = "plane strain"
mesh = {{ file = "block.geo" }}
support = [{{ on = "left", displacement = {{ x = 0 }} }}]
load = [{{ on = "top", pressure = 10 }}]

[[contact]]
on = "bottom"

[contact.normal_law]
kind = "{kind}"
parameters = {{ p0 = 2.0, h = 1e-3 }}
"""
GEOMETRY = """
SetFactory("OpenCASCADE");
Rectangle(1) = {0, 0, 0, 1, 1};
Physical Curve("bottom") = {1};
Physical Curve("top") = {3};
Physical Curve("left") = {4};
Physical Surface("block") = {1};
Mesh.MeshSizeMax = 0.5;
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The present folder, with a module of laws, a geometry and no law allowed."""
    path = COMM.bcast(tmp_path)

    def write():
        (path / "rough.py").write_text(MODULE)
        (path / "block.geo").write_text(GEOMETRY)

    on_root(COMM, write)
    monkeypatch.chdir(path)
    monkeypatch.setattr(allowed, "_modules", {})
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.delitem(sys.modules, "rough", raising=False)
    return path


def written(folder, kind="rough:Asperities"):
    on_root(COMM, lambda: (folder / "scene.toml").write_text(SCENE.format(kind=kind)))
    return "scene.toml"


def test_the_command_line_allows_it_and_its_closed_form_comes_out(folder):
    scene = written(folder)
    assert main(["run", scene, "--laws", "rough", "--out", "out", "--quiet"]) == 0
    found = json.loads((folder / "out/result.json").read_text())
    depth = 1e-3 * np.log(1 + 10 / 2)
    assert found["quantities"]["max_penetration"] == pytest.approx(depth, rel=1e-7)
    energy = 2 * (1e-3 * np.expm1(depth / 1e-3) - depth)
    assert found["quantities"]["penalty_energy"] == pytest.approx(energy, rel=1e-7)
    assert found["contacts"][0]["parameters"].items() >= {"h": 1e-3, "p0": 2.0}.items()
    assert found["contacts"][0]["contact"] == "rough:Asperities"


@pytest.mark.parametrize("command", ["run", "check", "sweep"])
def test_a_scene_alone_runs_nothing(folder, command, capfd):
    arguments = ["--vary", "load.0.pressure=5,10"] if command == "sweep" else []
    if COMM.size > 1 and arguments:
        pytest.skip("a sweep runs on one rank each")
    code = main([command, written(folder), *arguments])
    said = capfd.readouterr()
    assert code == 2
    assert not (folder / "rough.ran").exists()
    assert "rough" not in sys.modules
    if COMM.rank == 0:
        assert "say --laws rough" in re.sub(r"\s+", " ", said.out + said.err)


@pytest.mark.skipif(COMM.size > 1, reason="a sweep runs on one rank each")
def test_processes_of_a_sweep_have_what_the_command_line_allows(folder):
    words = ["sweep", written(folder), "--vary", "load.0.pressure=5,10", "--jobs", "2"]
    assert main([*words, "--laws", "rough", "--out", "out", "--quiet"]) == 0
    rows = (folder / "out/sweep.csv").read_text().splitlines()
    assert len(rows) == 3
    assert main(["report", "out", "--quiet"]) == 0


@pytest.mark.parametrize(
    ("module", "kind", "words"),
    [
        ("rough", "rough:Asperity", "did you mean 'Asperities'?"),
        ("rough", "rough:Helper", "it has Asperities"),
        ("rough", "rough:UserContactEnergy", "has no class 'UserContactEnergy'"),
        ("rough", "os:system", "the module 'os' are not allowed"),
        ("no_such_module", "rough:Asperities", "the module cannot be imported"),
    ],
)
def test_what_is_not_there_is_refused_in_a_sentence(folder, module, kind, words, capfd):
    assert main(["check", written(folder, kind), "--laws", module]) == 2
    said = capfd.readouterr()
    if COMM.rank == 0:
        assert words in re.sub(r"\s+", " ", said.out + said.err)


def test_it_has_what_laws_of_the_program_have(folder):
    """In Python, with friction: the answer, checks, bars and derivatives of the same formula."""
    assert allow_laws("rough") == ["Asperities", "Saturated", "Helper"]
    own = OwnNormalLaw("rough:Asperities", {"p0": 2.0, "h": 1e-3})
    formula = law("p0 * (exp(d / h) - 1)", p0=2.0, h=1e-3)
    scenes = [
        pressed(BALL, {"normal_law": one, "friction_coefficient": 0.3}) for one in (own, formula)
    ]
    first, second = (run(scene, COMM, box_body((12, 6))) for scene in scenes)
    assert first.passed, first.verdict
    for name, value in second.quantities.items():
        assert first.quantities[name] == pytest.approx(value, rel=1e-6, abs=1e-9), name
    assert first.errors.keys() == second.errors.keys()
    key = "contact.0.normal_law.parameters.h"
    slopes = [
        Study(scene, COMM, box_body((12, 6))).derivatives(["strain_energy"], [key])
        for scene in scenes
    ]
    assert slopes[0]["strain_energy"][key] == pytest.approx(
        slopes[1]["strain_energy"][key], rel=1e-5
    )


def test_a_bound_of_friction_is_one_too(folder):
    """Where points slip they carry it; at a pressure of 10 it is a third less than Coulomb's."""
    allow_laws("rough")
    table = {"kind": "rough:Saturated", "parameters": {"p0": 20.0}}
    keys = {"friction_coefficient": 0.2, "friction_law": table}
    result = run(sheared(keys), COMM, box_body((6, 3)))
    assert result.passed, result.verdict
    slips, pressure = result.points.status == "SLIP", result.points.contact_pressure[:]
    assert slips.any()
    traction = np.linalg.norm(result.points.friction_traction, axis=1)
    bound = 0.2 * pressure / (1 + pressure / 20)
    assert traction[slips] == pytest.approx(bound[slips], rel=1e-3)
    assert (traction <= bound * (1 + 1e-6) + 1e-9).all()


def test_no_module_is_allowed_to_begin_with(folder):
    with refused("laws_of_module_not_allowed"):
        run(
            pressed(BALL, {"normal_law": OwnNormalLaw("rough:Asperities")}),
            COMM,
            box_body((2, 2)),
        )


def test_a_rule_that_says_its_state_update_by_the_earlier_name_is_asked_by_it():
    """Overridden, called, and called on the class that it derives from."""

    class Polished(UserFriction):
        def at_step_end(self, slip, closed):
            return {}

        def step_end_pulled_back(self, slip, closed, of_end):
            return super().step_end_pulled_back(slip, closed, of_end)[0] + 1, {"way": 2}

    class Twice(Polished):
        def vjp_state_update(self, slip, closed, of_end):
            return slip, {}

    rule, twice = (made.__new__(made) for made in (Polished, Twice))
    slip = np.zeros((2, 3))
    found, others = rule.vjp_state_update(slip, None, {})
    assert found.tolist() == np.ones((2, 3)).tolist()
    assert others == {"way": 2}
    assert rule.has_vjp
    assert twice.step_end_pulled_back(slip, None, {}) == (slip, {})
    assert not twice.has_vjp
