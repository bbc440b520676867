"""Rigid indenters on a half-space: flat, a cylinder and a sphere, against closed solutions."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from math import pi
from typing import Literal

from fenics_contact.analytic import contact as formulas
from fenics_contact.common.program import mesh_file
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import HalfSpace, Obstacle
from fenics_contact.scene.scene import Discretisation, MeshSource, Scene
from fenics_contact.verification.case import Case, Finding, of_quantity, radius_of_area, solved

JOHNSON = "K. L. Johnson, Contact Mechanics, Cambridge 1985"

_INNER, _OUTER, _INDENTATION = 0.5, 1.0, 0.01
# Bonded over frictionless: a separate FEniCSx prototype of example 4, domain of 1000 radii.
_BONDED_OVER_FRICTIONLESS = 1.0276


def _annulus(quick: bool) -> Iterator[Finding]:
    """Forces over that of a flat circular punch of the outer radius."""
    punch = formulas.flat_punch_force(MODULUS, _OUTER, _INDENTATION)
    exact = formulas.annular_punch_force(MODULUS, _INNER, _OUTER, _INDENTATION)
    frictionless, bonded = _force("unilateral"), _force("bonded")
    yield Finding("F / (2 E* a d)", frictionless / punch, exact / punch, 1e-3, absolute=True)
    yield Finding(
        "bonded / frictionless force",
        bonded / frictionless,
        _BONDED_OVER_FRICTIONLESS,
        1e-3,
        absolute=True,
    )


def annulus_scene(kind: Literal["unilateral", "bonded"] = "unilateral") -> Scene:
    """A flat annular punch driven into a half-space."""
    return Scene(
        kinematics="axisymmetric",
        mesh=(
            MeshSource(
                mesh_file("annular_punch.geo"),
                cell="quadrilateral",
                parameters={"inner_radius": _INNER, "outer_radius": _OUTER, "extent": 1000},
            ),
        ),
        material=MATERIAL,
        symmetry=("axis",),
        half_space=HalfSpace(("outer",)),
        contact=(Contact("contact", contact=kind, obstacle=Obstacle(indentation=_INDENTATION)),),
    )


def _force(kind: Literal["unilateral", "bonded"]) -> float:
    return float(solved(annulus_scene(kind)).quantities["normal_force"])


PUNCH_CASES: tuple[Case, ...] = (
    Case(
        "annulus",
        "flat annular punch, frictionless and bonded",
        "integral equation of ring loads (Johnson 1985, section 3.8); the bonded ratio: a separate "
        "prototype of example 4 of Campos, Oden & Kikuchi 1982",
        _annulus,
    ),
)


_LINE_HALF_WIDTH = 8.0**0.5
# The formula is for half-widths small against the radius. On a curved body what the surface
# moves sideways changes it by order (1 − 2ν) a/R: by 2 % at a/R = 1/8, and by .5 % here.
_CYLINDER_RADIUS, _CYLINDER_HALF_WIDTH = 32.0, 1.0


def _line(quick: bool) -> Iterator[Finding]:
    """By force, which in half a model is half of it."""
    force = formulas.line_force(MODULUS, RADIUS, _LINE_HALF_WIDTH)
    for held_by in ("half-space", "supports"):
        scene = Scene(
            kinematics="plane strain",
            mesh=(MeshSource(mesh_file("half_space.geo"), cell="quadrilateral"),),
            material=MATERIAL,
            symmetry=("axis",),
            half_space=HalfSpace(("outer",)) if held_by == "half-space" else None,
            support=(Support("outer", {"y": 0}),) if held_by == "supports" else (),
            contact=(
                Contact("contact", obstacle=Obstacle("parabola", radius=RADIUS, force=force / 2)),
            ),
        )
        expected = formulas.line_contact(MODULUS, RADIUS, force)
        yield from _compared(scene, expected, 5e-3, f", {held_by}")


def _cylinder(quick: bool) -> Iterator[Finding]:
    force = formulas.line_force(MODULUS, _CYLINDER_RADIUS, _CYLINDER_HALF_WIDTH)
    scene = Scene(
        kinematics="plane strain",
        mesh=(
            MeshSource(
                mesh_file("cylinder.geo"),
                cell="quadrilateral",
                order=2,
                parameters={"radius": _CYLINDER_RADIUS, "contact_angle": 5},
            ),
        ),
        material=MATERIAL,
        symmetry=("axis",),
        load=(Load("top", traction=(0, -force / 2 / _CYLINDER_RADIUS)),),
        contact=(Contact("contact", obstacle=Obstacle("plane", normal=(0, 1))),),
    )
    expected = formulas.line_contact(MODULUS, _CYLINDER_RADIUS, force)
    yield from _compared(scene, expected, 1e-2)


def _compared(
    scene: Scene, expected: formulas.HertzContact, tolerance: float, label: str = ""
) -> Iterator[Finding]:
    """Half-width and peak pressure of half a model."""
    result = solved(scene)
    yield of_quantity(result, "contact_area", expected.radius, tolerance, f", half-width{label}")
    yield of_quantity(result, "max_contact_pressure", expected.peak, tolerance, label)


LINE_CASES: tuple[Case, ...] = (
    Case("line", "parabola on a half-plane, by force", f"{JOHNSON}, (4.43), (4.45)", _line),
    Case(
        "cylinder",
        "elastic cylinder on a rigid plane",
        f"{JOHNSON}, (4.43), (4.45)",
        _cylinder,
    ),
)


YOUNGS_MODULUS, POISSONS_RATIO = 1000.0, 0.3
MATERIAL = (Material(YOUNGS_MODULUS, POISSONS_RATIO),)
MODULUS = formulas.plane_strain_modulus(YOUNGS_MODULUS, POISSONS_RATIO)
RADIUS, INDENTATION = 8.0, 1.0
HERTZ = formulas.paraboloid(MODULUS, RADIUS, INDENTATION)

_POINT = f"{JOHNSON}, (4.22)-(4.24)"
_EXTENT_OVER_RADIUS = 20.0
_STIFFNESS = 100.0
_STIFF = 1e9


def half_space_scene(obstacle: Obstacle, **parameters: float) -> Scene:
    """An axisymmetric piece of a half-space; the parameters are those of its mesh."""
    return Scene(
        kinematics="axisymmetric",
        mesh=(
            MeshSource(
                mesh_file("half_space.geo"), cell="quadrilateral", parameters=dict(parameters)
            ),
        ),
        material=MATERIAL,
        symmetry=("axis",),
        half_space=HalfSpace(("outer",)),
        contact=(Contact("contact", obstacle=obstacle),),
    )


def on_fixed_boundary(scene: Scene) -> Scene:
    """The same with the outer boundary held instead of the half-space beyond it."""
    return dataclasses.replace(
        scene, half_space=None, support=(Support("outer", {"x": 0, "y": 0}),)
    )


def _paraboloid(**driven: float) -> Obstacle:
    return Obstacle("paraboloid", radius=RADIUS, **driven)  # type: ignore[arg-type]


def _hertz(quick: bool) -> Iterator[Finding]:
    result = solved(half_space_scene(_paraboloid(indentation=INDENTATION)))
    yield of_quantity(result, "normal_force", HERTZ.force, 2e-3)
    yield of_quantity(result, "max_contact_pressure", HERTZ.peak, 2e-3)
    yield radius_of_area(result, "contact_area", "contact radius", HERTZ.radius, 5e-3)


def _sphere(quick: bool) -> Iterator[Finding]:
    force, radius = formulas.sphere(MODULUS, RADIUS, INDENTATION)
    obstacle = Obstacle("sphere", radius=RADIUS, indentation=INDENTATION)
    result = solved(half_space_scene(obstacle))
    yield of_quantity(result, "normal_force", force, 2e-3)
    yield radius_of_area(result, "contact_area", "contact radius", radius, 5e-3)


def _force_driven(quick: bool) -> Iterator[Finding]:
    result = solved(half_space_scene(_paraboloid(force=HERTZ.force)))
    yield of_quantity(result, "indentation", INDENTATION, 2e-3)


def _small_domain(quick: bool) -> Iterator[Finding]:
    extent = _EXTENT_OVER_RADIUS * HERTZ.radius
    scene = half_space_scene(_paraboloid(indentation=INDENTATION), extent=extent)
    yield of_quantity(solved(scene), "normal_force", HERTZ.force, 2e-3)


def _reaction(quick: bool) -> Iterator[Finding]:
    scene = on_fixed_boundary(half_space_scene(_paraboloid(indentation=INDENTATION)))
    quantities = solved(scene).quantities
    yield Finding("reaction", quantities["reaction"][1], quantities["normal_force"], 1e-9)


def _penalty(quick: bool) -> Iterator[Finding]:
    scene = half_space_scene(_paraboloid(indentation=INDENTATION))
    chosen = solved(scene)
    smaller = chosen.contacts[0]["parameters"]["penalty_parameter"] / 10
    contact = dataclasses.replace(scene.contact[0], penalty_parameter=smaller)
    stiffer = solved(dataclasses.replace(scene, contact=(contact,)))
    for quantity in ("normal_force", "max_contact_pressure"):
        change = chosen.quantities[quantity] / stiffer.quantities[quantity] - 1
        yield Finding(f"change of {quantity}", change, 0.0, 1e-3, absolute=True)


def _springs(quick: bool) -> Iterator[Finding]:
    """∫ k (d − r²/2R) 2πr dr up to r² = 2Rd."""
    contact = Contact(
        "contact",
        obstacle=_paraboloid(indentation=INDENTATION),
        foundation_stiffness=_STIFFNESS,
    )
    scene = on_fixed_boundary(half_space_scene(_paraboloid(), extent=10))
    scene = dataclasses.replace(
        scene, material=(Material(_STIFF, POISSONS_RATIO),), contact=(contact,)
    )
    force = pi * _STIFFNESS * RADIUS * INDENTATION**2
    yield of_quantity(solved(scene), "normal_force", force, 1e-3)


def _quarter(**parameters: float) -> Finding:
    """A quarter of a 3D half-space, degree 2."""
    scene = Scene(
        kinematics="3D",
        mesh=(MeshSource(mesh_file("quarter_space.geo"), parameters=parameters),),
        material=MATERIAL,
        discretisation=Discretisation(2),
        symmetry=("symmetry_x", "symmetry_y"),
        half_space=HalfSpace(("outer",)),
        contact=(Contact("contact", obstacle=_paraboloid(indentation=INDENTATION)),),
    )
    force = 4 * solved(scene).quantities["normal_force"]
    cells = "hexahedra" if parameters["hexahedra"] else "tetrahedra"
    return Finding(f"4 × normal_force, {cells}", force, HERTZ.force, 1e-2)


def _quarter_space(quick: bool) -> Iterator[Finding]:
    size = 0.9 if quick else 0.6
    yield _quarter(hexahedra=1, size=size, cells_outside=6)
    yield _quarter(hexahedra=0, size=size, cells_outside=6)


POINT_CASES: tuple[Case, ...] = (
    Case("hertz", "paraboloid on a half-space", _POINT, _hertz),
    Case(
        "sphere",
        "sphere, no paraboloid, on a half-space",
        "I. N. Sneddon, Int. J. Engng Sci. 3 (1965) 47-57",
        _sphere,
    ),
    Case("force", "paraboloid driven by a force", _POINT, _force_driven),
    Case("half_space", "a domain of 20 contact radii as half-space", _POINT, _small_domain),
    Case("quarter", "paraboloid on a quarter of a 3D half-space", _POINT, _quarter_space),
    Case("reaction", "contact force against that of the supports", "equilibrium", _reaction),
    Case("penalty", "the automatic ε₁ against a tenth of it", "the limit ε₁ → 0", _penalty),
    Case(
        "springs",
        "paraboloid on springs under a rigid body",
        "F = π k R d², the integral of k (d − r²/2R)",
        _springs,
    ),
)
