"""Which runs have formulas, and which have none: on results made up for the purpose."""

import dataclasses
from math import cbrt, pi, sqrt

import numpy as np
import pytest

from fenics_contact import Contact, HalfSpace, Load, Material, MeshSource, Obstacle, Scene, Support
from fenics_contact.analytic import contact as formulas
from fenics_contact.body.supports import HeldDofs, SymmetryPlane
from fenics_contact.report.recognition import recognise
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.scene.values import Profile
from tests.records import made_run

pytestmark = pytest.mark.serial
MODULUS = formulas.plane_strain_modulus(1000, 0.3)
RADIUS, DEPTH = 8.0, 0.02  # a = .4
HERTZ = formulas.paraboloid(MODULUS, RADIUS, DEPTH)


def pressed(kinematics="axisymmetric", shape="paraboloid", **contact):
    """An obstacle on a half-space."""
    obstacle = contact.pop("obstacle", Obstacle(shape, RADIUS, indentation=DEPTH))
    return Scene(
        kinematics=kinematics,
        mesh=MeshSource("any.geo"),
        material=Material(1000, 0.3),
        half_space=HalfSpace(("outer",)),
        contact=(Contact("contact", obstacle=obstacle, **contact),),
    )


def table(x, y=None, normal=(0.0, 1.0, 0.0), closed=0.4):
    """Points of a contact; those within a distance of the origin touch."""
    points = np.zeros((len(x), 3))
    points[:, 0], points[:, 1] = x, 0.0 if y is None else y
    near = np.linalg.norm(points, axis=1) < closed
    zero = np.zeros(len(x))
    names = ("gap", "contact_pressure", "traction_x", "traction_y", "traction_z")
    numbers = dict(zip("xyz", points.T, strict=True)) | {name: zero for name in names}
    numbers |= {f"n{axis}": zero + n for axis, n in zip("xyz", normal, strict=True)}
    status = np.where(near, "STICK", "OPEN")
    return ContactTable(np.full(len(x), "contact"), status, numbers)


LINE, WHOLE = table(np.linspace(0, 1, 41)), table(np.linspace(-1, 1, 81))


def result(force, friction=(), law="none", symmetry="none", name="contact"):
    """A run with these forces at its load steps."""
    forces = np.atleast_1d(force)
    friction = np.atleast_2d(friction) if len(friction) else np.zeros((len(forces), 2))
    steps = [
        {
            "load_factor": float(number + 1),
            "quantities": {"normal_force": p},
            "contacts": [{"quantities": {"normal_force": p, "friction_force": list(q)}}],
            "supports": [],
        }
        for number, (p, q) in enumerate(zip(forces.tolist(), friction.tolist(), strict=True))
    ]
    contact = {"name": name, "law": law, "quantities": {"normal_force": float(forces[-1])}}
    return made_run({"model": {"symmetry": symmetry}, "contacts": [contact], "steps": steps})


def mirrored(run, symmetry):
    return dataclasses.replace(run, model=dataclasses.replace(run.model, symmetry=symmetry))


def of_two_bodies(run):
    contact = dataclasses.replace(run.contacts[0], slave="up.contact", master="low.contact")
    return dataclasses.replace(run, contacts=[contact])


@pytest.mark.parametrize("shape", ["paraboloid", "sphere"])
def test_hertz_on_a_half_space(shape):
    found = recognise(pressed(shape=shape), result(HERTZ.force), LINE, None)
    assert found.label == "Hertz" and found.smooth and not found.line
    assert found.hertz.radius == pytest.approx(sqrt(RADIUS * DEPTH))
    r = np.array([0, 0.2, 0.4, 0.5])
    expected = HERTZ.peak * np.sqrt([1, 0.75, 0, 0])
    assert found.pressure(r) == pytest.approx(expected, abs=1e-6 * HERTZ.peak)


def test_hertz_of_a_quarter_in_space():
    """A quarter carries a quarter of the force."""
    x, y = (grid.ravel() for grid in np.meshgrid(np.linspace(0, 1, 9), np.linspace(0, 1, 9)))
    rows = table(x, y, normal=(0, 0, 1))
    quarter = result(HERTZ.force / 4, symmetry="quarter (x = 0, y = 0)")
    found = recognise(pressed("3D"), quarter, rows, None)
    assert found.hertz.radius == pytest.approx(0.4)
    misses = result(HERTZ.force / 2, symmetry="half (x = 0.5)")
    assert recognise(pressed("3D"), misses, rows, None) is None


def test_hertz_of_a_line_contact():
    line = formulas.line_contact(MODULUS, RADIUS, 20.0)
    rows = table(np.linspace(-1, 1, 81))
    found = recognise(pressed("plane strain", "parabola"), result(20.0), rows, None)
    assert found.line and found.hertz == line


@pytest.mark.parametrize(
    ("poissons_ratio", "depth", "shear"),
    [(0.1, 0.17, 0.408), (0.2, 0.32, 0.330), (0.3, 0.786, 0.3)],
)
def test_largest_shear_below_a_line_contact(poissons_ratio, depth, shear):
    """Of all directions: with a small ν it is that between σ_z and σ_y = ν (σ_x + σ_z).

    That is half of 1/√(1 + s²) − 2 ν (√(1 + s²) − s), which is greatest at these depths; for ν = .3
    Johnson has .30 p₀ at .78 a, between σ_z and σ_x (Section 4.2).
    """
    scene = pressed("plane strain", "parabola")
    scene = dataclasses.replace(scene, material=(Material(1000, poissons_ratio),))
    found = recognise(scene, result(20.0), WHOLE, None)
    depths = np.linspace(0, 2, 2001)
    values = found.axis_shear(depths * found.hertz.radius) / found.hertz.peak
    assert values.max() == pytest.approx(shear, abs=6e-4)
    assert depths[values.argmax()] == pytest.approx(depth, abs=6e-3)


@pytest.mark.parametrize("shape", ["parabola", "flat punch"])
@pytest.mark.parametrize(
    ("x", "covers"),
    [
        (np.linspace(-1, 1, 81), True),
        (np.linspace(-0.3, 1, 53), False),  # cut off on one side
        (np.linspace(0, 1, 41), False),
        (np.append(np.linspace(-1, 0.1, 45), np.linspace(0.3, 1, 29)), False),  # a hole
        (np.sign(np.linspace(-1, 1, 81)) * np.linspace(-1, 1, 81) ** 2, True),  # graded
    ],
)
def test_a_surface_that_does_not_cover_the_contact_has_no_formula(shape, x, covers):
    scene = pressed("plane strain", obstacle=Obstacle(shape, 8 if shape == "parabola" else 0.4))
    found = recognise(scene, result(22.0), table(x), None)  # of the parabola a = .45
    assert (found is not None) == covers


def test_cover_in_space():
    """All around, and also where a corner of the surface reaches as far as the contact."""
    grid = np.linspace(-1, 1, 41)
    x, y = (values.ravel() for values in np.meshgrid(grid, grid))
    for inside, covers in (
        (x < 2, True),
        (x < 0.33, False),  # the contact has the radius .4
        (np.hypot(x - 0.1, y) > 0.13, False),
        (np.hypot(x - 0.7, y) > 0.13, True),
    ):
        rows = table(x[inside], y[inside], normal=(0, 0, 1))
        found = recognise(pressed("3D"), result(HERTZ.force), rows, None)
        assert (found is not None) == covers


def test_plane_of_symmetry_far_from_the_origin():
    """Planes are told to rounding, and compared within the size of the surface."""
    place = 1234.56789
    obstacle = Obstacle("parabola", RADIUS, force=10, position=(place, 0))
    rows = table(np.linspace(0, 1, 81))
    rows.numbers["x"] += place
    rows = ContactTable(rows.contact, rows.status, rows.numbers)
    scene = pressed("plane strain", obstacle=obstacle)
    held = object.__new__(HeldDofs)  # its planes alone
    held.planes = [SymmetryPlane("left", 0, place)]
    found = recognise(scene, result(10.0, symmetry=held.symmetry), rows, None)
    assert found.hertz == formulas.line_contact(MODULUS, RADIUS, 20.0)
    tiny = Obstacle("parabola", 8e-6, force=1e-6, position=(3e-7, 0))
    rows = table(np.linspace(0, 1e-6, 81), closed=1e-7)
    scene = pressed("plane strain", obstacle=tiny)
    assert recognise(scene, result(1e-6, symmetry="half (x = 0)"), rows, None) is None


def test_flat_punch():
    """All of the force, and no peak: it is infinite at the edge."""
    punch = Obstacle("flat punch", 0.5, indentation=0.01)
    found = recognise(pressed(obstacle=punch), result(100.0), LINE, None)
    t = (np.arange(2000) + 0.5) / 2000 * pi / 2
    r = 0.5 * np.sin(t)
    force = 2 * pi * np.mean(found.pressure(r) * r * 0.5 * np.cos(t)) * pi / 2
    assert force == pytest.approx(100, rel=1e-6)
    assert found.pressure(np.array([0.6]))[0] == 0
    strip = recognise(pressed("plane strain", obstacle=punch), result(100.0), WHOLE, None)
    assert 2 * np.mean(strip.pressure(r) * 0.5 * np.cos(t)) * pi / 2 == pytest.approx(100, rel=1e-6)


@pytest.mark.parametrize(
    "change",
    [
        {"half_space": None, "support": (Support("outer", {"y": 0}),)},
        {"support": (Support("outer", {"y": 0}),)},
        {"material": (Material(1000, 0.3, on="a"), Material(2000, 0.3, on="b"))},
        {"material": (Material(stiffness=np.diag([3.0, 3, 3, 1, 1, 1])),)},
        {"material": (Material(Profile("y", (0, 1), (1, 2)), 0.3),)},
        {"contact": (Contact("contact", pressure=1.0),)},
        {"contact": (Contact("contact", foundation_stiffness=10.0),)},
        {"contact": (Contact("contact", contact="bonded"),)},
        {"contact": pressed(obstacle=Obstacle(indentation=0.1)).contact},
        {"contact": pressed(obstacle=Obstacle("annular punch", 8, 4, indentation=1)).contact},
    ],
)
def test_other_scenes_have_no_formula(change):
    scene = dataclasses.replace(pressed(), **change)
    assert recognise(scene, result(HERTZ.force), LINE, None) is None


def test_other_results_have_no_formula():
    good = result(HERTZ.force)
    assert recognise(pressed(), good, LINE, None) is not None
    assert recognise(None, good, LINE, None) is None
    two = dataclasses.replace(good, contacts=2 * good.contacts)
    assert recognise(pressed(), two, LINE, None) is None
    assert recognise(pressed(), result(0.0), LINE, None) is None
    assert recognise(pressed(), good, table(np.linspace(0, 1, 41), closed=0.0), None) is None
    narrow = table(np.linspace(0, 0.2, 11))  # narrower than the formula's contact
    assert recognise(pressed(), good, narrow, None) is None
    for normal, count in (((0, -2), 1), ((0.1, -1), 0), ((1e-8, -1e-7), 0)):
        obstacle = Obstacle("parabola", 8, normal=normal, force=20)
        found = recognise(pressed("plane strain", obstacle=obstacle), result(20.0), WHOLE, None)
        assert (found is not None) == count, normal
    finite = dataclasses.replace(pressed(), half_space=None, load=(Load("top", pressure=1),))
    assert recognise(finite, good, LINE, None) is None
    wide = formulas.paraboloid(MODULUS, RADIUS, 1.0).force  # a/R = .35: no sphere's any more
    rows = table(np.linspace(0, 5, 41))
    assert recognise(pressed(shape="sphere"), result(wide), rows, None) is None
    assert recognise(pressed(shape="paraboloid"), result(wide), rows, None) is not None


def sheared(poissons_ratio=0.49, **contact):
    scene = pressed("plane strain", "parabola", **({"law": "incremental"} | contact))
    return dataclasses.replace(scene, material=(Material(1000, poissons_ratio),))


def test_friction_changes_the_label_where_it_changes_the_pressure():
    rows = table(np.linspace(-1, 1, 81))
    for poissons_ratio, label in ((0.3, "Hertz, without friction"), (0.49, "Hertz")):
        scene = sheared(poissons_ratio, friction_coefficient=0.5)
        found = recognise(scene, result(20.0, law="incremental"), rows, None)
        assert found.label == label and not found.smooth and found.direction is None


def test_cattaneo_and_mindlin():
    """c = a √(1 − Q/μP), and the traction adds up to Q."""
    rows = table(np.linspace(-1, 1, 81))
    scene = sheared(friction_coefficient=0.5)
    shear = [[0, 0], [-3, 0], [-6, 0]]
    found = recognise(scene, result([20.0] * 3, shear, "incremental"), rows, None)
    assert found.direction == 0
    assert found.stick == pytest.approx(found.hertz.radius * sqrt(0.4))
    x = np.linspace(-1, 1, 20001) * found.hertz.radius
    assert np.mean(found.friction(x)) * np.ptp(x) == pytest.approx(-6, rel=1e-3)


@pytest.mark.parametrize(
    ("force", "shear", "law"),
    [
        ([20.0] * 3, [0, -6, -3], "incremental"),  # less than before
        ([20.0] * 3, [0, -6, 6 * 0.9], "incremental"),
        ([10.0, 10, 20], [0, -3, -6], "incremental"),  # pressed on while sheared
        ([20.0] * 3, [0, -6, -10], "incremental"),  # all of it slips
        ([20.0] * 3, [0, -3, -6], "static"),
    ],
)
def test_other_paths_have_no_formula_of_friction(force, shear, law):
    rows = table(np.linspace(-1, 1, 81))
    scene = sheared(friction_coefficient=0.5, law=law)
    friction = [[q, 0] for q in shear]
    found = recognise(scene, result(force, friction, law), rows, None)
    assert found is not None and found.direction is None


def test_cattaneo_in_space():
    x, y = (grid.ravel() for grid in np.meshgrid(np.linspace(-1, 1, 17), np.linspace(0, 1, 9)))
    rows = table(x, y, normal=(0, 0, 1))
    scene = pressed("3D", friction_coefficient=0.3, law="incremental")
    scene = dataclasses.replace(scene, material=(Material(1000, 0.5 - 1e-9),))
    most = 0.3 * HERTZ.force / 2
    shear = [[0, 0.1 * most, 0], [0.488 * most, 0.1 * most, 0]]  # across it the mirror image adds 0
    half = result([HERTZ.force / 2] * 2, shear, "incremental", "half (y = 0)")
    found = recognise(scene, half, rows, None)
    assert found.direction == 0
    assert found.stick == pytest.approx(found.hertz.radius * cbrt(0.512))


def discs(radius, apart=0.0, ripple=0.0, sides=(1, -1)):
    """Two bodies with curved sides that face each other, 2 wide and 2 high; and their points."""
    import pyvista

    x, depth = np.linspace(-1, 1, 33), np.linspace(0, 1, 9)
    across, down = np.meshgrid(x, depth, indexing="ij")
    blocks = []
    for side in sides:
        centre = 0.0 if side > 0 else apart
        height = (across - centre) ** 2 / (2 * radius) + ripple * np.cos(20 * across)
        points = [across, side * (height + 4 * down), 0 * across]
        stacked = [values[:, :, None] for values in points]
        blocks.append(pyvista.StructuredGrid(*stacked).cast_to_unstructured_grid())
    body = blocks[0].merge(blocks[1], merge_points=False)
    y = x**2 / (2 * radius) + ripple * np.cos(20 * x)
    return body, table(x, y, normal=(0, -1, 0), closed=0.1)


def pair(kinematics="plane strain"):
    scene = Scene(
        kinematics=kinematics,
        mesh=(MeshSource("a.geo", name="up"), MeshSource("b.geo", name="low")),
        material=(Material(1000, 0.3), Material(500, 0.2, on="low")),
        support=(Support("low.face", {"y": 0}), Support("up.face", {"y": -0.1})),
        contact=(Contact("up.contact", against="low.contact"),),
    )
    found = of_two_bodies(result(2.0))
    return scene, found


def test_hertz_of_two_cylinders():
    body, rows = discs(10.0)
    found = recognise(*pair(), rows, body)
    compliance = 1 / MODULUS + 1 / formulas.plane_strain_modulus(500, 0.2)
    expected = formulas.line_contact(1 / compliance, 5.0, 2.0)
    assert found.hertz.radius == pytest.approx(expected.radius, rel=1e-3)
    assert found.hertz.peak == pytest.approx(expected.peak, rel=1e-3)


@pytest.mark.parametrize("sides", [(1, -1), (-1, 1)])
def test_bodies_may_come_in_any_order(sides):
    """Also where the first of the contact's points is a node of both: runs on ranks have that."""
    body, rows = discs(10.0, sides=sides)
    rows = rows.rows(np.roll(np.arange(len(rows.status)), -16))
    assert rows.numbers["x"][0] == 0
    numbers = np.random.default_rng(0).permutation(body.n_points)  # nodes may be in any order
    cells = np.array(body.cells).reshape(-1, 5)
    cells[:, 1:] = np.argsort(numbers)[cells[:, 1:]]
    body = type(body)(cells.ravel(), body.celltypes, body.points[numbers])
    assert recognise(*pair(), rows, body) is not None


@pytest.mark.parametrize(
    "bodies", [{"apart": 0.5}, {"ripple": 0.01}, {"apart": 0.0, "radius": -10.0}]
)
def test_other_pairs_have_no_formula(bodies):
    body, rows = discs(**({"radius": 10.0} | bodies))
    assert recognise(*pair(), rows, body) is None


def half(radius, start=0.0):
    """One side of two round bodies."""
    import pyvista

    x, depth = np.linspace(0, 1, 33), np.linspace(0, 1, 9)
    across, down = np.meshgrid(x, depth, indexing="ij")
    blocks = []
    for side in (1, -1):
        height = radius - np.sqrt(radius**2 - across**2)
        points = [across + start, side * (height + 4 * down), 0 * across]
        stacked = [values[:, :, None] for values in points]
        blocks.append(pyvista.StructuredGrid(*stacked).cast_to_unstructured_grid())
    rows = table(x, radius - np.sqrt(radius**2 - x**2), normal=(0, -1, 0), closed=0.1)
    rows.numbers["x"] += start
    return blocks[0].merge(blocks[1], merge_points=False), rows


def test_half_of_two_real_cylinders():
    """A circle is no parabola: the apex of what is fitted to one side is beside the plane."""
    body, rows = half(10.0)
    scene, found = pair()
    found = mirrored(found, "half (x = 0)")
    found.contacts[0].quantities["normal_force"] = 0.3
    compliance = 1 / MODULUS + 1 / formulas.plane_strain_modulus(500, 0.2)
    expected = formulas.line_contact(1 / compliance, 5.0, 0.6)
    recognised = recognise(scene, found, rows, body)
    assert recognised.centre[0] == 0
    assert recognised.hertz.radius == pytest.approx(expected.radius, rel=2e-3)
    found = mirrored(found, "half (x = 1)")
    assert recognise(scene, found, rows, body) is None


def test_a_ring_of_contact_has_no_formula():
    """Bodies of revolution touch at a point only where their apexes lie on the axis."""
    scene, found = pair("axisymmetric")
    body, rows = half(10.0)
    found.contacts[0].quantities["normal_force"] = 0.05
    assert recognise(scene, found, rows, body) is not None
    body, rows = half(10.0, start=5.0)
    assert recognise(scene, found, rows, body) is None
    body, rows = discs(10.0)
    body.points[:, 0] += 5.0
    rows.numbers["x"] += 5.0
    assert recognise(scene, found, rows, body) is None


def test_friction_of_two_bodies_that_are_stretched_has_no_formula():
    """Where a body is held besides on its sides, or unevenly, what sticks is off the middle."""
    body, rows = discs(10.0)
    scene, _ = pair()
    rough = Contact(
        "up.contact", against="low.contact", law="incremental", friction_coefficient=0.3
    )
    scene = dataclasses.replace(scene, material=(Material(1000, 0.3),), contact=(rough,))
    found = of_two_bodies(result([2.0] * 3, [[0, 0], [-0.15, 0], [-0.3, 0]], "incremental"))
    shift = Support("up.face", {"x": 0.01})
    stretched = (Support("low.left", {"x": -0.05}), Support("low.right", {"x": 0.05}))
    uneven = (Support("up.face", {"x": Profile("x", (-1, 1), (0, 1))}),)
    for more, direction in (((shift,), 0), (stretched, None), (uneven, None)):
        changed = dataclasses.replace(scene, support=scene.support + more)
        recognised = recognise(changed, found, rows, body)
        assert recognised.label == "Hertz" and recognised.direction == direction


def test_large_contact_of_two_bodies_has_no_formula():
    body, rows = discs(10.0)
    scene, found = pair()
    found.contacts[0].quantities["normal_force"] = 100.0  # a = .87, bodies 2 wide
    assert recognise(scene, found, rows, body) is None
