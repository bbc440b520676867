"""Only what the scene needs: terms, compiled integrals, and refusals."""

import dataclasses

import pytest
from dolfinx import jit
from mpi4py import MPI

from fenics_contact import Contact, Load, Material, Profile, Run, Scene, Support, run
from fenics_contact.solve.load_steps.load_stepper import solve
from tests.messages import refused
from tests.scenes import box_body, slab

COMM = MPI.COMM_WORLD
BOUNDARY, CELL = "exterior_facet", "cell"
SURFACE = CELL  # of the contact surface, a mesh of its own

FRICTIONLESS = slab(coefficient=0.0)
FRICTION = slab()
NO_PRESSURE = slab(pressure=0.0)
TWO_LOADS = dataclasses.replace(
    slab(coefficient=Profile("x", (0, 8), (0.1, 0.3))),
    load=(
        Load("right", traction=(0, 0)),
        Load("right", pressure=10),
        Load("slab", body_force=(0, -1)),
    ),
)


@pytest.mark.parametrize(
    ("scene", "expected"),
    [
        (
            FRICTION,
            {
                "elastic energy": [CELL],
                "traction on right": [BOUNDARY],
                "contact pressure on top": [SURFACE],
                "regularised friction on top": [SURFACE] * 2,
            },
        ),
        (
            FRICTIONLESS,
            {
                "elastic energy": [CELL],
                "traction on right": [BOUNDARY],
                "contact pressure on top": [SURFACE],
            },
        ),
        (NO_PRESSURE, {"elastic energy": [CELL], "traction on right": [BOUNDARY]}),
        (
            TWO_LOADS,
            {
                "elastic energy": [CELL],
                "pressure on right": [BOUNDARY],
                "body force on slab": [CELL],
                "contact pressure on top": [SURFACE],
                "regularised friction on top": [SURFACE] * 2,
            },
        ),
    ],
)
def test_terms_and_compiled_integrals(scene, expected):
    prepared = Run(scene, COMM)
    assert {term.name: term.integrals for term in prepared.problem.terms} == expected
    assert prepared.model["terms"] == list(expected)


def test_without_friction_one_linear_step_and_no_law():
    result = run(FRICTIONLESS, COMM)
    assert result.steps[0]["newton_iterations"] == 1
    assert result.steps[0]["outer_iterations"] == 0
    assert result.contacts[0]["law"] == "none"
    assert result.contacts[0]["parameters"]["regularisation_parameter"] == 0
    assert set(result.checks) == {"equilibrium", "resultant", "boundary_stress", "linear_range"}


def test_no_iteration_compiles_anything(monkeypatch):
    prepared = Run(slab(end_load=600), COMM)

    def refuse(*arguments, **options):
        raise AssertionError("a form was compiled during the solve")

    monkeypatch.setattr(jit, "ffcx_jit", refuse)
    assert solve(prepared.problem).newton_iterations > 3


def test_forms_are_shared_by_contacts_and_loads_of_one_kind():
    """Tags are not compiled in: two pads and two tractions need the code of one."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        load=(Load("x0", traction=(1, 0)), Load("x1", traction=(2, 0))),
        contact=(
            Contact("pad", pressure=1, friction_coefficient=0.1),
            Contact("y1", name="rest", pressure=1, friction_coefficient=0.2),
        ),
    )
    body = box_body((4, 4), (2, 1), patches={"pad": ("y1", lambda x: x[0] < 1)})
    groups = dict(body.groups)
    groups["y1"] = dataclasses.replace(groups["y1"], tags=groups["y1"].tags[:1])
    prepared = Run(scene, COMM, dataclasses.replace(body, groups=groups))
    names = [[f.module.__name__ for f in term.forms] for term in prepared.problem.terms]
    assert names[1] == names[2]
    assert names[5] == names[6]
    result = prepared.solve()
    areas = [contact["quantities"]["contact_area"] for contact in result.contacts]
    assert areas == pytest.approx([1, 1])


def test_contact_may_not_overlap_a_support_or_a_contact():
    scene = dataclasses.replace(slab(), support=(*slab().support, Support("top", {"x": 0})))
    with refused("contact_shares_boundary_with_support"):
        Run(scene, COMM)
    twice = dataclasses.replace(
        slab(), contact=(*slab().contact, Contact("top", name="again", pressure=1))
    )
    with refused("contact_shares_boundary_with_contact"):
        Run(twice, COMM)


def test_supports_that_contradict_each_other_are_refused():
    scene = dataclasses.replace(slab(), support=(*slab().support, Support("right", {"y": 0.1})))
    with refused("supports_prescribe_differently"):
        Run(scene, COMM)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"contact": (Contact("tpo", pressure=1),)}, "no_group_tpo"),
        ({"contact": (Contact("slab", pressure=1),)}, "contact_of_a_part"),
        ({"load": (Load("slab", pressure=1),)}, "load_of_a_part"),
        ({"load": (Load("top", body_force=(0, 1)),)}, "body_force_of_a_side"),
        ({"support": (Support("lfet", {"x": 0}),)}, "no_group_lfet"),
        ({"kinematics": "3D", "load": ()}, "mesh_of_dimension_2"),
    ],
)
def test_scene_that_does_not_fit_its_mesh(change, message):
    with refused(message):
        Run(dataclasses.replace(slab(), **change), COMM)


def test_body_of_another_dimension_is_refused():
    with refused("kinematics_of_another_dimension"):
        Run(slab(), COMM, box_body((1, 1, 1)))


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (lambda x: x[0] - 4, "pressure_is_negative_somewhere"),
        (lambda x: x[0] / 0 * float("nan"), "pressure_not_finite"),
        (lambda x: x[7], "pressure_fails_with_index"),
        (lambda x: [1, 2, 3], "pressure_fails_with_shape"),
    ],
)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_bad_functions_of_position_are_named(function, message):
    with refused(message):
        Run(slab(pressure=function), COMM)


def test_varying_pressure_and_coefficient_reach_the_contact_points():
    """g = μ(x) p(x); resultants against integrals of polynomials (Simpson is exact)."""
    result = run(slab(pressure=lambda x: 100 + 25 * x[0], coefficient=0.3), COMM)
    points = result.points
    assert points.contact_pressure == pytest.approx(100 + 25 * points.coordinates[:, 0])
    assert result.quantities["normal_force"] == pytest.approx(100 * 8 + 25 * 32)
    profile = run(slab(pressure=Profile("x", (0, 8), (100, 300)), coefficient=0.3), COMM)
    assert profile.quantities["friction_force"] == pytest.approx(
        result.quantities["friction_force"]
    )
    slipping = points.status == "SLIP"
    bound = 0.3 * points.contact_pressure
    assert slipping.any()
    traction = points.friction_traction[:, 0]
    assert traction[slipping] == pytest.approx(bound[slipping], rel=1e-9)
    assert (traction[~slipping] <= bound[~slipping]).all()


def test_petsc_options_of_one_problem_do_not_reach_the_next():
    """PETSc's options are global; each run takes back those it set."""
    from petsc4py import PETSc

    before = PETSc.Options().getAll()
    run(slab())
    assert PETSc.Options().getAll() == before
