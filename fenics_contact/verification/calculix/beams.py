"""A beam of 1 × 1 × 8 with couplings, masses and springs at its end, and a tube that is twisted.

The inputs have quadratic cells with reduced integration (``C3D20R``), 2 × 2 × 8 of them, clamped at
z = 0. Scenes have as many cells, of full degree 2: such cells are a little stiffer, by some
thousandths in bending and torsion. Forces and moments are statics; what the inputs find of them on
the section is 0.99996 of what they give.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import pi
from typing import Any

import numpy as np

from fenics_contact.analyses.vibration.table import Modes
from fenics_contact.common.arrays import Array
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.loading.conditions import Load, Point
from fenics_contact.scene.loading.couplings import Coupling, Spring
from fenics_contact.scene.loading.support_axes import SupportAxes
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.settings import SolverSettings
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.calculix.stated import STEEL, SUITE, stated
from fenics_contact.verification.case import Case, Finding, solved

_CLAMP = Support("beam.z0", {"x": 0.0, "y": 0.0, "z": 0.0}, moment_about=(0.0, 0.0, 0.0))
_CENTRE = (0.5, 0.5, 8.0)
_END = (Point("end", _CENTRE),)
# What the inputs of couplings give.
_PULL, _TORQUE = 7910.861, 131.4474
_NONE = (0.0, 0.0, 0.0)
# The share of these that a scene has: all of them turn the beam far out of linear theory.
_SHARE = 1e-3
_TWIST = 0.01
_THICK = 0.2  # of the block in plane strain
# Of beams that are stiffer by full integration, and of forces and moments.
_STIFFER, _STATICS = 5e-3, 1e-4


def _beam(height: float = 1.0) -> Body:
    part = Box("beam", (0.0, 0.0, 0.0), (1.0, height, 8.0), (2, 2, 8))
    return boxes([part], "hexahedron")


def _of_beam(body: Body | None = None, **given: Any) -> Result:
    """The beam's answer.

    Args:
        body: Another one than the beam of the inputs, without a point at its end.
        **given: Of its scene, in place of what it has.
    """
    parts: dict[str, Any] = {
        "material": (STEEL,),
        "support": (_CLAMP,),
        "point": _END if body is None else (),
        "solver": SolverSettings(errors="none"),
    }
    return solved(Scene(kinematics="3D", **parts | given), body or _beam())


def _on_section(
    force: Sequence[float] = _NONE,
    moment: Sequence[float] = _NONE,
    at: tuple[float, float, float] | None = None,
    body: Body | None = None,
) -> tuple[Array, Array]:
    """Force on the end, and its moment about the origin: what the clamp answers to a coupling's."""
    end = Coupling(
        "beam.z1",
        kind="distributing",
        at=at,
        force=tuple(_SHARE * np.array(force)),
        moment=tuple(_SHARE * np.array(moment)),
    )
    reaction = _of_beam(body, coupling=(end,)).reactions["beam.z0"]
    found = (reaction.reaction, reaction.reaction_moment)
    return -np.array(found[0]) / _SHARE, -np.array(found[1]) / _SHARE


def _rigid(quick: bool) -> Iterator[Finding]:
    """Ends that move as a whole: along the beam, eccentrically pulled, turned."""
    shift = 3.792103e-05
    pulled = _of_beam(support=(_CLAMP, Support("beam.z1", {"z": shift})))
    force = pulled.reactions["beam.z1"].reaction[2]
    yield Finding("coupling1: force that moves the end", force, 0.99996, _STIFFER)
    corner = Coupling("beam.z1", at=(0.0, 0.0, 0.0), force=(0.0, 0.0, 1.0))
    found = _of_beam(coupling=(corner,)).quantities["displacement_end"]
    reference = (9.058159e-04, 9.058159e-04, 3.774682e-05)
    yield from stated("coupling2: displacement", found, reference, _STIFFER)
    # The input holds four nodes of the end together, which is elastic between them.
    turned = _of_beam(coupling=(Coupling("beam.z1", moment=(0.0, 1.0, 0.0)),))
    sag = float(turned.quantities["displacement_end"][0])
    yield Finding("beamprb: sag under a moment", sag, 1.80949e-03, _STIFFER)


def _turning(at: tuple[float, float]) -> Support:
    """The end turned about the beam's axis, free along the radius and the axis."""
    axes = SupportAxes(cylindrical=(0.0, 0.0, 1.0), at=(*at, 0.0))

    def turn(x: Array) -> Array:
        return np.asarray(_TWIST * np.hypot(x[0] - at[0], x[1] - at[1]))

    return Support("beam.z1", {"around": turn}, axes=axes)


def _torque(support: Support, body: Body | None = None) -> float:
    result = _of_beam(body, support=(_CLAMP, support))
    return float(np.array(result.reactions["beam.z1"].reaction_moment)[2])


def _twisted(quick: bool) -> Iterator[Finding]:
    """Torque of a square bar and of a tube."""
    yield Finding(
        "coupling3: torque of a square bar", _torque(_turning((0.5, 0.5))), 14.38206, 1e-2
    )
    part = Box("beam", (0.0, 1.0, 0.0), (2 * pi, 1.1, 8.0), (16, 1, 10))
    tube = boxes([part], "hexahedron", order=2, closed=("beam",))
    places = tube.mesh.geometry.x
    angle, radius = places[:, 0].copy(), places[:, 1].copy()
    places[:, 0], places[:, 1] = radius * np.cos(angle), radius * np.sin(angle)
    yield Finding("cyl: torque of a tube", _torque(_turning((0.0, 0.0)), tube), 73.5889, 1e-3)


def _straight(quick: bool) -> Iterator[Finding]:
    """Forces and moments at the point of a distributing coupling."""
    force, moment = _on_section(force=(0, 0, _PULL), moment=(0, 0, _TORQUE))
    yield from stated("coupling6: force", force, (0, 0, 7910.545), _STATICS)
    about = (3955.272, -3955.272, 131.4435)
    yield from stated("coupling6: moment", moment, about, _STATICS)
    force, moment = _on_section(force=(0, _PULL, 0))
    yield from stated("coupling8: force", force, (0, 7910.545, 0), _STATICS)
    yield from stated("coupling8: moment", moment, (-63284.26, 0, 3955.272), _STATICS)
    _, moment = _on_section(moment=(_TORQUE, 0, 0))
    yield from stated("coupling9: moment", moment, (131.4433, 0, 0), _STATICS)
    force, moment = _on_section(at=(0.5, 0.0, 8.0), force=(0, 0, _PULL))
    yield from stated("coupling11: force", force, (0, 0, 7910.545), _STATICS)
    yield from stated("coupling11: moment", moment, (0, -3955.272, 0), _STATICS)
    # This older keyword spreads forces without a moment, wherever its point is.
    force, moment = _on_section(force=(0, 9.0, 0))
    yield from stated("distcoup: force", force, (0, 9.0, 0), _STATICS)
    yield from stated("distcoup: moment", moment, (-72.0, 0, 4.5), _STATICS)


def _oblique(quick: bool) -> Iterator[Finding]:
    """The same of a beam that lies obliquely in space."""
    first, second = (0.857167, 0.0, -0.515038), (0.150583, 0.956305, 0.250611)
    axes = np.array([first, second, np.cross(first, second)])
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    body = _beam()
    body.mesh.geometry.x[:] = body.mesh.geometry.x @ axes
    along, across = axes[2], axes[0]
    force, moment = _on_section(_PULL * along, _TORQUE * along, body=body)
    yield from stated("coupling7: force", force, (3896.208, -2312.818, 6484.378), _STATICS)
    yield from stated("coupling7: moment", moment, (2859.464, -3820.871, -2920.597), _STATICS)
    _, moment = _on_section(moment=_TORQUE * across, body=body)
    yield from stated("coupling10: moment", moment, (112.6689, 0, -67.69829), _STATICS)


def _sprung(quick: bool) -> Iterator[Finding]:
    """A spring, and a mass under gravity and in vibration, at the end; a block on a spring."""
    held = Coupling("beam.z1", kind="distributing", name="end", force=(0, 9.0, 0))
    spring = Spring(("end", "ground"), stiffness={"y": 10.0})
    sag = _of_beam(coupling=(held,), spring=(spring,)).quantities["displacement_end"][1]
    yield Finding("distcoupspring: sag", float(sag), 7.978760e-02, _STIFFER)
    mass = Coupling("beam.z1", kind="distributing", mass=0.9)
    pull = Load("beam", acceleration=(0, 10.0, 0))
    # The input's beam has no mass, and its load acts on the one node in the middle of the end.
    light = replace(STEEL, density=1e-12)
    hung = _of_beam(material=(light,), coupling=(mass,), load=(pull,))
    sag = hung.quantities["displacement_end"][1]
    yield Finding("mass1: sag", float(sag), 8.778365e-02, _STIFFER)
    mass = Coupling("beam.z1", kind="distributing", mass=1e-4)
    # From the third on, along the beam, what gives way is the surroundings of the input's one node.
    modes = _of_beam(_beam(height=1.5), coupling=(mass,), modes=Modes(2)).modes
    for mode, reference in zip(modes, (197.6396, 293.4710), strict=True):
        name = f"mass2: frequency {mode.number}"
        yield Finding(name, mode.natural_frequency, reference, _STIFFER)


def _block_on_spring(quick: bool) -> Iterator[Finding]:
    """A block in plane strain, whose weight does not matter, moves along a spring."""
    block = boxes([Box("block", (1.0, -0.1), (1.2, 0.1), (1, 1))])
    scene = Scene(
        kinematics="plane strain",
        material=(STEEL,),
        support=(Support("block", {"y": 0.0}), Support("block.x0", stiffness={"x": 10.0 / _THICK})),
        load=(Load("block.x1", force=(1.999 / _THICK, 0.0)),),
        point=(Point("front", (1.2, 0.0)),),
        modes=Modes(1),
        solver=SolverSettings(errors="none"),
    )
    result = solved(scene, block)
    moved = float(result.quantities["displacement_front"][0])
    yield Finding("spring4: displacement", moved, 1.999445e-01, _STATICS)
    frequency = result.modes[0].natural_frequency
    yield Finding("spring4: frequency", frequency, 63709.95, _STATICS)


def _beams(quick: bool) -> Iterator[Finding]:
    for part in (_rigid, _twisted, _straight, _oblique, _sprung, _block_on_spring):
        yield from part(quick)


CALCULIX_BEAM_CASES: tuple[Case, ...] = (
    Case(
        "calculix_beams",
        "sixteen inputs of CalculiX's tests: couplings, masses and springs at a beam's end",
        SUITE.format("coupling1", "dat.ref") + " (of beamprb in beamprb.frd.ref)",
        _beams,
    ),
)
