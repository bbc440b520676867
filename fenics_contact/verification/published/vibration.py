"""Natural modes of bodies that touch, and what joints damp of them, against formulas."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from fenics_contact.analyses.vibration.table import Damping, Modes
from fenics_contact.common.parallel import total
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.settings import SolverSettings
from fenics_contact.simulation.studies.study import Study
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Case, Finding, UntrustedError, note_mesh, solved
from fenics_contact.verification.published.cycle import cyclic_scene
from fenics_contact.verification.published.shear import loss, shear_share, shift

_YOUNG, _LENGTH, _HEIGHT, _LIMIT = 1000.0, 20.0, 0.2, 0.3
# Between the plane's end and the mass, so that modes have a stiffness while all is stuck.
_SPRING = _LENGTH / 10
_PARTS = ("bar", "spring", "mass")


def bar_scene() -> Scene:
    """The bar, the piece of it beyond the plane, and the mass."""
    return Scene(
        kinematics="plane stress",
        material=(
            Material(_YOUNG, 0.0, on="bar", density=1e-9),
            Material(_YOUNG, 0.0, on="spring", density=1e-9),
            Material(100 * _YOUNG, 0.0, on="mass", density=1.0),
        ),
        support=tuple(Support(f"{name}.y0", {"y": 0}) for name in _PARTS),
        contact=(Contact("bar.y1", pressure=1.0, friction_coefficient=_LIMIT, law="incremental"),),
        modes=Modes(1),
        damping=Damping((0.01,)),
        solver=SolverSettings(errors="none"),
    )


def bar_body(cells: int) -> Body:
    """Its mesh.

    Args:
        cells: Along the plane, a multiple of 10.
    """
    cell, end = _LENGTH / cells, _LENGTH + _SPRING
    return boxes(
        (
            Box("bar", (0, 0), (_LENGTH, _HEIGHT), (cells, 1)),
            Box("spring", (_LENGTH, 0), (end, _HEIGHT), (cells // 10, 1)),
            Box("mass", (end, 0), (end + cell, _HEIGHT), (1, 1)),
        ),
        welded=(_PARTS,),
    )


def bar(cells: int = 40, shares: tuple[float, ...] = (0.2, 0.5, 0.8)) -> Iterator[Finding]:
    """Loss, damping ratio and frequency over the force, 1 %.

    Args:
        cells: Along the plane.
        shares: Forces over the largest that friction holds.
    """
    section = _YOUNG * _HEIGHT
    joint = Joint(
        moved=lambda force: force**2 / (2 * section * _LIMIT) + force * _SPRING / section,
        loss=lambda force: 2 * force**3 / (3 * section * _LIMIT),
    )
    forces = tuple(share * _LIMIT * _LENGTH for share in shares)
    yield from compared(bar_scene(), bar_body(cells), joint, forces, 1e-2, axis=0)


# 40,000 unknowns; load steps from one end of the way to the other.
_MESH = {"fine": 1.1, "size": 1.1 / 6, "cells_outside": 3}
_STEPS = 8


def paraboloid(shares: tuple[float, ...] = (0.6, 0.9)) -> Iterator[Finding]:
    """Loss and damping ratio of a cycle over the shear that comes out, 2 %.

    The half body counts twice. U = ½ Q δ stands for the energy of a mode of that force and way.
    """
    for expected in shares:
        scene = cyclic_scene(expected, _STEPS, **_MESH)
        solver = dataclasses.replace(scene.solver, errors="none")
        result = solved(dataclasses.replace(scene, solver=solver))
        begun, ended = (result.steps[step * _STEPS]["quantities"] for step in (1, 3))
        lost = 2 * (ended["friction_work"] - begun["friction_work"])
        share = shear_share(ended)
        at = f"Q = ±{share:.2f} μP"
        yield Finding(f"loss, {at}", lost, loss(share), 2e-2)
        shear = 2 * abs(ended["friction_force"][0])
        ratio = lost / (2 * math.pi * shear * shift(expected))
        exact = loss(share) / (2 * math.pi * shear * shift(share))
        yield Finding(f"damping ratio, {at}", ratio, exact, 2e-2)


_YOUNG_MODES, _DENSITY, _LENGTH_MODES, _HEIGHT_MODES = 1000.0, 2.0, 50.0, 1.0
# (βL)² of a beam that is clamped at one end, and what shear and turning take off here.
_CANTILEVER = ((3.516015, 1e-3), (22.034492, 3e-3), (61.697214, 7e-3))


def _scene(support: tuple[Support, ...]) -> Scene:
    return Scene(
        kinematics="plane stress",
        material=(Material(_YOUNG_MODES, 0.0, density=_DENSITY),),
        support=support,
        load=(Load("bar.x1", traction=(1e-3, 0)),),
        modes=Modes(3),
        solver=SolverSettings(errors="none"),
    )


def _modes(quick: bool) -> Iterator[Finding]:
    body = boxes((Box("bar", (0, 0), (_LENGTH_MODES, _HEIGHT_MODES), (50, 2)),))
    sides = (Support("bar.y0", {"y": 0}), Support("bar.y1", {"y": 0}))
    found = solved(_scene((Support("bar.x0", {"x": 0, "y": 0}), *sides)), body).modes
    speed = math.sqrt(_YOUNG_MODES / _DENSITY)
    for mode in found:
        exact = (2 * mode.number - 1) * speed / (4 * _LENGTH_MODES)
        yield Finding(f"bar, frequency {mode.number}", mode.natural_frequency, exact, 1e-6)
    found = solved(_scene((Support("bar.x0", {"x": 0, "y": 0}),)), body).modes
    unit = speed * math.sqrt(_HEIGHT_MODES**2 / 12) / (2 * math.pi * _LENGTH_MODES**2)
    for mode, (square, tolerance) in zip(found, _CANTILEVER, strict=True):
        name = f"cantilever, frequency {mode.number}"
        yield Finding(name, mode.natural_frequency, square * unit, tolerance)


MODES_CASES: tuple[Case, ...] = (
    Case(
        "modes",
        "natural frequencies of a bar and of a cantilever",
        "ω = (2j − 1)πc/2L; (βL)² = 3.516015, 22.034492, 61.697214 of Euler's beam",
        _modes,
    ),
)


_LAYER_E, _LAYER_L, _LAYER_H, _PRESSURE, _FRICTION = 1e5, 40.0, 1.0, 1.0, 0.3
_CELLS = 60


def _layers() -> Scene:
    heavy, light = 1.0, 1e-6
    return Scene(
        kinematics="plane stress",
        material=(
            Material(_LAYER_E, 0.0, on="lower", density=light),
            Material(_LAYER_E, 0.0, on="upper", density=light),
            Material(_LAYER_E, 0.0, on="lower_end", density=heavy),
            Material(_LAYER_E, 0.0, on="upper_end", density=heavy),
        ),
        support=(Support("lower.x0", {"x": 0, "y": 0}), Support("upper.x0", {"x": 0, "y": 0})),
        load=tuple(
            Load(f"{name}{end}.{side}", pressure=_PRESSURE)
            for name, side in (("lower", "y0"), ("upper", "y1"))
            for end in ("", "_end")
        ),
        contact=tuple(
            Contact(
                f"upper{end}.y0",
                against=f"lower{end}.y1",
                friction_coefficient=_FRICTION,
                law="incremental",
            )
            for end in ("", "_end")
        ),
        solver=SolverSettings(errors="none"),
    )


def layers() -> Iterator[Finding]:
    """Loss, damping ratio and frequency over the force, 3 %."""
    cell = _LAYER_L / _CELLS
    begin = _LAYER_L - 0.5 * cell  # the mass acts at its middle
    parts = [
        box
        for name, low in (("lower", -_LAYER_H), ("upper", 0.0))
        for box in (
            Box(name, (0, low), (begin, low + _LAYER_H), (_CELLS, 2)),
            Box(f"{name}_end", (begin, low), (begin + cell, low + _LAYER_H), (1, 2)),
        )
    ]
    body = boxes(parts, welded=[(name, f"{name}_end") for name in ("lower", "upper")])
    stiff = 2 * _LAYER_E * _LAYER_H**3 / _LAYER_L**3
    first = 4 / 3 * _FRICTION * _PRESSURE * _LAYER_H
    joint = Joint(
        moved=lambda force: first / stiff + 4 * (force - first) / stiff,
        loss=lambda force: (
            8 * _FRICTION * _PRESSURE * _LAYER_L**3 * (force - first) / (_LAYER_E * _LAYER_H**2)
        ),
    )
    yield from compared(_layers(), body, joint, (1.5 * first, 2 * first, 3 * first), 3e-2, axis=1)


@dataclass(frozen=True)
class Joint:
    """What a force to and fro at the joint does, by formulas.

    Attributes:
        moved: Force → how far it moves where it acts, on the first loading (length).
        loss: Force → what a cycle loses (energy).
    """

    moved: Callable[[float], float]
    loss: Callable[[float], float]


def compared(
    scene: Scene,
    body: Body,
    joint: Joint,
    forces: tuple[float, ...],
    tolerance: float,
    axis: int,
    has_frequency: bool = True,
) -> Iterator[Finding]:
    """The lowest mode driven by forces that have given resultants, beside a joint's formulas.

    Args:
        scene: Without modes; where it has mass, it moves as a whole.
        body: Its mesh.
        joint: The formulas.
        forces: Resultants (force).
        tolerance: Of loss, damping ratio and frequency.
        axis: Number of the axis along which it moves.
        has_frequency: Whether the formulas tell all of what is moved.
    """
    comm = body.mesh.comm
    study = Study(replace(scene, modes=Modes(1), damping=None), comm, body)
    mode = study.vibration().shapes[0]
    prepared = study.prepare()
    note_mesh(prepared.model)
    kept = prepared.problem.spaces.owned_nodes
    # Of the forces that drive the mode: their sum, over the amplitude.
    stiffness = mode.circular_frequency**2 * abs(float(total(comm, mode.forces[:kept, axis].sum())))
    driven = Damping(amplitudes=tuple(force / stiffness for force in forces))
    found = study.vibration(replace(study.scene, damping=driven))
    if found.notes:
        raise UntrustedError(found.notes[0])
    for force, row in zip(forces, found.damping, strict=True):
        share = f" at {force / forces[-1]:.2g} of the largest force"
        yield Finding(f"loss{share}", row.loss, joint.loss(force), tolerance)
        if not has_frequency:
            continue
        moved = joint.moved(force)
        ratio = joint.loss(force) / (2 * math.pi * force * moved)
        yield Finding(f"damping_ratio{share}", row.damping_ratio, ratio, tolerance)
        frequency = math.sqrt(force / (moved * mode.mass)) / (2 * math.pi)
        yield Finding(f"natural_frequency{share}", row.natural_frequency, frequency, tolerance)


def _damping(quick: bool) -> Iterator[Finding]:
    joints = {"bar": bar, "layers": layers} | ({} if quick else {"paraboloid": paraboloid})
    for name, found in joints.items():
        for finding in found():
            yield dataclasses.replace(finding, quantity=f"{name}, {finding.quantity}")


DAMPING_CASES: tuple[Case, ...] = (
    Case(
        "damping",
        "damping and frequency over amplitude: a bar on a plane, two layers, a paraboloid",
        "ζ = D/(4πU); bar: D = 2F³/(3EAτ); layers: L. E. Goodman and J. H. Klumpp, J. Appl. Mech. "
        "23 (1956) 421-429; paraboloid: R. D. Mindlin and H. Deresiewicz, J. Appl. Mech. 20 (1953) "
        "327-344",
        _damping,
    ),
)
