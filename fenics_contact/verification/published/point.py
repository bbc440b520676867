"""Rigid spheres and paraboloids on an elastic half-space, and on springs."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from math import pi

from fenics_contact.analytic import contact as formulas
from fenics_contact.common.program import mesh_file
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Support
from fenics_contact.scene.obstacle import HalfSpace, Obstacle
from fenics_contact.scene.scene import Discretisation, MeshSource, Scene
from fenics_contact.verification.case import Case, Finding, of_quantity, radius_of_area, solved

YOUNGS_MODULUS, POISSONS_RATIO = 1000.0, 0.3
MATERIAL = (Material(YOUNGS_MODULUS, POISSONS_RATIO),)
MODULUS = formulas.plane_strain_modulus(YOUNGS_MODULUS, POISSONS_RATIO)
RADIUS, INDENTATION = 8.0, 1.0
HERTZ = formulas.paraboloid(MODULUS, RADIUS, INDENTATION)

JOHNSON = "K. L. Johnson, Contact Mechanics, Cambridge 1985"
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


CASES: tuple[Case, ...] = (
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
