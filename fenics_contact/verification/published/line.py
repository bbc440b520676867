"""Line contact in plane strain: a rigid parabola on a body, a curved body on a rigid plane."""

from __future__ import annotations

from collections.abc import Iterator

from fenics_contact.analytic import contact as formulas
from fenics_contact.common.program import mesh_file
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load, Support
from fenics_contact.scene.obstacle import HalfSpace, Obstacle
from fenics_contact.scene.scene import MeshSource, Scene
from fenics_contact.verification.case import Case, Finding, of_quantity, solved
from fenics_contact.verification.published.point import JOHNSON, MATERIAL, MODULUS, RADIUS

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


CASES: tuple[Case, ...] = (
    Case("line", "parabola on a half-plane, by force", f"{JOHNSON}, (4.43), (4.45)", _line),
    Case(
        "cylinder",
        "elastic cylinder on a rigid plane",
        f"{JOHNSON}, (4.43), (4.45)",
        _cylinder,
    ),
)
