"""Finite strains against closed forms: blocks between plates, a ring, a strip that buckles."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from fenics_contact.analytic.finite_strains import flattened_ring, lubricated_block
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.quantities.names import MIN_STRETCH
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.laws import energies
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Scene, SolverSettings, Steps
from fenics_contact.simulation.runs import run
from fenics_contact.verification.boxes import Box, boxes, quarter_rings
from fenics_contact.verification.case import (
    Case,
    Finding,
    UntrustedError,
    note_mesh,
    solved,
)

MODULUS, RATIO = 1.0, 0.3
_SHEAR = MODULUS / (2 * (1 + RATIO))
#: Constants of energies that have some, with the same moduli in small strains.
CONSTANTS: Mapping[str, Mapping[str, float]] = {
    energies.MOONEY: {"c10": 0.3 * _SHEAR, "c01": 0.2 * _SHEAR},
    energies.YEOH: {"c10": 0.5 * _SHEAR, "c20": -0.02 * _SHEAR, "c30": 0.01 * _SHEAR},
}


def rubber(law: str) -> Material:
    """A material of a stored energy, with the moduli above in small strains."""
    if law in CONSTANTS:
        return Material(poissons_ratio=RATIO, law=law, constants=CONSTANTS[law])
    return Material(MODULUS, RATIO, law=law)


_NO_ERRORS = SolverSettings(errors="none")
_RESTS_ON = Obstacle(shape="plane", position=(0, 0), normal=(0, 1))


def pressed_block(law: str, depth: float, friction: float = 0.0, steps: int = 1) -> Scene:
    """A block of height 1 on a rigid plane, its left side in a plane of symmetry.

    Args:
        law: Name of the stored energy.
        depth: How far its top is pressed down, which keeps its width free (length).
        friction: Coefficient at the plane.
        steps: Load steps.
    """
    return Scene(
        kinematics="plane strain",
        strains="finite",
        material=(rubber(law),),
        symmetry=("block.x0",),
        support=(Support("block.y1", {"y": -depth}),),
        contact=(
            Contact(
                "block.y0",
                obstacle=_RESTS_ON,
                friction_coefficient=friction,
                law="incremental" if friction else "static",
            ),
        ),
        steps=Steps(number=steps),
        solver=_NO_ERRORS,
    )


def block(cells: tuple[int, int] = (4, 4), width: float = 1.0) -> Body:
    """Mesh of a block of height 1 (length)."""
    return boxes([Box("block", (0, 0), (width, 1), cells)])


def _lubricated(quick: bool) -> Iterator[Finding]:
    stretches = (0.8, 0.5) if quick else (0.9, 0.8, 0.7, 0.5, 0.3)
    for law in energies.names():
        for stretch in stretches:
            if law == energies.ST_VENANT and stretch < 0.6:
                continue  # its force falls again below a stretch of 1/√3
            scene = pressed_block(law, 1 - stretch, steps=1 if stretch >= 0.5 else 2)
            found = _uniform(scene)
            reference = lubricated_block(law, stretch, MODULUS, RATIO, CONSTANTS.get(law))
            label = f"of the {law} block at a stretch of {stretch:g}"
            force = found.quantities["normal_force"]
            yield Finding(f"normal_force {label}", force, reference, 1e-8)
            least = found.quantities[MIN_STRETCH]
            yield Finding(f"min_stretch {label}", least, stretch, 1e-8)


def _uniform(scene: Scene) -> Result:
    """The answer of a block, which it may leave by itself: its sides wrinkle in large strains.

    M. A. Biot, Mechanics of Incremental Deformations, Wiley 1965: a free surface of incompressible
    rubber does so in plane strain from a stretch of .544 on.

    Raises:
        UntrustedError: There is none, or another check than that of stability fails.
    """
    result = run(scene, body=block())
    note_mesh(result.model)
    failed = {name for name, check in result.checks.items() if not check.passed}
    if not result.converged or failed - {"stable_equilibrium"}:
        raise UntrustedError(result.verdict)
    return result


_THICKNESS = 0.04  # of the ring, over its radius
_OF_THICKNESS = 0.01  # that elastica has none: of a ring half as thick forces are half as far off


def ring(steps: int, flattened: float) -> Scene:
    """A quarter of a ring of radius 1 under a plate without friction.

    Args:
        steps: Load steps.
        flattened: Way of the plate (length).
    """
    plate = Obstacle(
        shape="plane", position=(0, 1 + _THICKNESS / 2), normal=(0, -1), indentation=flattened
    )
    return Scene(
        kinematics="plane strain",
        strains="finite",
        material=(Material(MODULUS, RATIO, law=energies.NEO_HOOKEAN),),
        symmetry=("ring.y0", "ring.y1"),
        contact=(Contact("ring.x1", obstacle=plate),),
        steps=Steps(number=steps),
        solver=_NO_ERRORS,
    )


def _flattened(quick: bool) -> Iterator[Finding]:
    steps, way = (5, 0.5) if quick else (7, 0.7)
    around = 30 if quick else 60
    half = _THICKNESS / 2
    body = quarter_rings([Box("ring", (1 - half, 0), (1 + half, 1), (2, around))])
    found = solved(ring(steps, way), body)
    stiffness = MODULUS * _THICKNESS**3 / 12 / (1 - RATIO**2)
    for step in found.steps:
        flattened = way * step.load_factor
        if flattened < 1 - 0.71778:
            continue  # it touches at a point yet
        force = -2 * step.quantities["contact_force"][1]
        reference = flattened_ring(1 - flattened, stiffness)
        yield Finding(f"force at {flattened:.1f} of the radius", force, reference, _OF_THICKNESS)


_SLENDER = 0.1  # width of a strip of length 1
#: Shortening at which it buckles, over its length: Euler's load over the stiffness of its sections.
BUCKLES_AT = math.pi**2 * _SLENDER**2 / 12


def compressed_strip(shortened: float) -> tuple[Scene, Body]:
    """A straight strip, clamped below and pressed by a plate without friction; collective.

    Args:
        shortened: Way of the plate over its length.
    """
    plate = Obstacle(shape="plane", position=(0, 1), normal=(0, -1), indentation=shortened)
    scene = Scene(
        kinematics="plane strain",
        strains="finite",
        material=(Material(MODULUS, RATIO, law=energies.NEO_HOOKEAN),),
        support=(Support("strip.y0", {"x": 0.0, "y": 0.0}),),
        contact=(Contact("strip.y1", obstacle=plate),),
        solver=_NO_ERRORS,
    )
    return scene, boxes([Box("strip", (0, 0), (_SLENDER, 1), (2, 12))])


def _buckling(quick: bool) -> Iterator[Finding]:
    """Shortening at which the check of stability begins to fail, beside Euler's."""
    low, high = 0.5 * BUCKLES_AT, 2.0 * BUCKLES_AT
    for _ in range(5 if quick else 8):
        middle = 0.5 * (low + high)
        scene, body = compressed_strip(middle)
        falls = not run(scene, body=body).checks["stable_equilibrium"].passed
        low, high = (low, middle) if falls else (middle, high)
    found = 0.5 * (low + high)
    yield Finding("shortening at which the straight strip buckles", found, BUCKLES_AT, 0.04)


FINITE_CASES = (
    Case(
        "finite_block",
        "blocks between plates without friction, by five stored energies",
        "closed forms of uniform stretches in plane strain",
        _lubricated,
    ),
    Case(
        "finite_ring",
        "a thin ring flattened between plates: large rotations, contact that spreads",
        "R. Frisch-Fay, Flexible Bars, Butterworths 1962: the elastica of a ring on plates",
        _flattened,
    ),
    Case(
        "finite_buckling",
        "a straight strip under a plate: where the check `stable_equilibrium` fails",
        "Euler's load of a strip clamped at one end and guided at the other, π² E I/L²",
        _buckling,
    ),
)
