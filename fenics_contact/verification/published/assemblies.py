"""Assemblies against textbook formulas: press fits and a bolted joint.

A shaft in a hub that is too tight, and the force that pushes it through. Lamé's pressure, of
bodies that overlap as they are drawn and of an interference by value; a force once published with
wrong answers of another program; and two blocks, where pressure is uniform.

The joint diagram: a bolt is tightened to F_V, locked, and pulled at its head by F_A. F = F_V + Φ
F_A with Φ = k_b/(k_b + k_p), until the parts separate at F_V/(1 − Φ); then F = F_A. Bolt and parts
are bars of ν = 0 between the ground and a rigid head, glued on top of them. What the penalties ε₁
of glue and contact give are springs ε₁/A in series with the bars.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from math import pi
from typing import Literal, get_args

import numpy as np

from fenics_contact.analytic.two_bodies import Tube, pressure
from fenics_contact.mesh.tagged_mesh import Body, Group
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Preload
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Discretisation, Scene, SolverSettings, Steps
from fenics_contact.scene.values import Path
from fenics_contact.verification.boxes import Box, boxes, quarter_rings
from fenics_contact.verification.case import Case, Finding, solved

Kinematics = Literal["axisymmetric", "plane strain"]

_LAME = "G. Lamé; S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, 1970, Section 28"
# Of bores 20 and 40, outer diameters 40.005 and 60 there are told a pressure of 5.74 and a force of
# 1371 at a coefficient of .1. The modulus, equal in both, and the length are those with which
# Lamé's formula gives these.
_THREAD = "CalculiX (GitHub, Dhondtguido/CalculiX), issue 98; modulus and length by Lamé's formula"
_BORE, _RADIUS, _OUTER, _INTERFERENCE = 10.0, 20.0, 30.0, 0.0025
_MODULUS, _LENGTH = 196e3, 19.0
_HIGH = 5.0  # of the axisymmetric pieces of a long fit
_COEFFICIENT, _FORCE, _PRESSURE = 0.1, 1371.0, 5.74
_RATIO = 0.3
# Pressures of curved facets that do not match go to and fro about their mean.
_WORST: dict[Kinematics, float] = {"axisymmetric": 2e-3, "plane strain": 1e-2}
_PUSHED = 0.004  # more than what the parts give before all slips


def _tubes(ratio: float) -> tuple[Tube, Tube]:
    shaft = Tube(_BORE, _RADIUS, _MODULUS, ratio)
    return shaft, Tube(_RADIUS, _OUTER, _MODULUS, ratio)


def long_fit(kinematics: Kinematics, drawn: bool) -> tuple[Scene, Body]:
    """A long shaft in a long hub, neither of which can become longer, and their meshes.

    Args:
        kinematics: ``axisymmetric`` or ``plane strain``.
        drawn: Whether they overlap as they are meshed, or by value.
    """
    radius = _RADIUS + (_INTERFERENCE if drawn else 0.0)
    by_value = 0.0 if drawn else _INTERFERENCE
    supports: tuple[Support, ...] = ()
    symmetry: tuple[str, ...] = ()
    if kinematics == "axisymmetric":
        parts = (
            Box("shaft", (_BORE, 0), (radius, _HIGH), (6, 3)),
            Box("hub", (_RADIUS, 0), (_OUTER, _HIGH), (6, 4)),
        )
        body = boxes(parts)
        supports = tuple(Support(f"{box.name}.y{end}", {"y": 0}) for box in parts for end in (0, 1))
    else:
        parts = (
            Box("shaft", (_BORE, 0), (radius, 1), (2, 20)),
            Box("hub", (_RADIUS, 0), (_OUTER, 1), (2, 24)),
        )
        body = quarter_rings(parts)
        symmetry = tuple(f"{box.name}.y{end}" for box in parts for end in (0, 1))
    scene = Scene(
        kinematics=kinematics,
        material=(Material(_MODULUS, _RATIO),),
        support=supports,
        symmetry=symmetry,
        contact=(Contact("shaft.x1", against="hub.x0", interference=by_value),),
        steps=Steps(2),
    )
    return scene, body


def _long(quick: bool) -> Iterator[Finding]:
    expected = pressure(*_tubes(_RATIO), _INTERFERENCE, is_long=True)
    for kinematics in get_args(Kinematics):
        for drawn in (False, True):
            if quick and drawn:
                continue
            result = solved(*long_fit(kinematics, drawn))
            label = f"{kinematics}, {'as drawn' if drawn else 'by value'}"
            area = 2 * pi * _RADIUS * (_HIGH if kinematics == "axisymmetric" else 0.25)
            mean = result.quantities["pressure_integral"] / area
            yield Finding(f"mean p, {label}", mean, expected, 2e-3)
            assert result.points is not None
            found = result.points.contact_pressure
            worst = float(found[np.argmax(np.abs(found - expected))])
            yield Finding(f"p, its worst point, {label}", worst, expected, _WORST[kinematics])
            work = 0.5 * expected * _INTERFERENCE * area
            value = result.quantities["external_work"]
            yield Finding(f"external_work, {label}", value, work, 2e-3)


def pushed_scene(ratio: float) -> Scene:
    """A shaft that is fitted by time 1, and pushed through at its end by time 2."""
    contact = Contact(
        "shaft.x1",
        against="hub.x0",
        law="incremental",
        friction_coefficient=_COEFFICIENT,
        interference=_INTERFERENCE,
    )
    return Scene(
        kinematics="axisymmetric",
        material=(Material(_MODULUS, ratio),),
        support=(
            Support("hub.y0", {"y": 0}),
            Support("shaft.y1", {"y": -_PUSHED}, path=Path(time=(1, 2), factor=(0, 1))),
        ),
        contact=(contact,),
        steps=Steps(times=(1.0, 1.5, 2.0)),
        solver=SolverSettings(errors="none"),
    )


def _pushed(quick: bool) -> Iterator[Finding]:
    parts = (
        Box("shaft", (_BORE, 0), (_RADIUS, _LENGTH), (4, 8)),
        Box("hub", (_RADIUS, 0), (_OUTER, _LENGTH), (4, 10)),
    )
    # With ν = 0 nothing bulges under the push, which the formula does not know.
    for ratio, tolerance in ((0.0, 1e-4), (_RATIO, 5e-3)):
        result = solved(pushed_scene(ratio), boxes(parts))
        label = f", ν = {ratio:g}"
        fitted = result.steps[0].quantities["pressure_integral"]
        mean = fitted / (2 * pi * _RADIUS * _LENGTH)
        yield Finding(f"mean pressure{label}", mean, _PRESSURE, 1e-2)
        force = result.quantities["friction_force"][1]
        yield Finding(f"force at gross slip{label}", force, _FORCE, tolerance)
        carried = _COEFFICIENT * result.quantities["pressure_integral"]
        yield Finding(f"force over μ∫p{label}", force / carried, 1.0, 1e-9)


def _blocks(quick: bool) -> Iterator[Finding]:
    """Pressure δ / (2 H/E + ε₁) for bars of height H, ν = 0; the work is ½ p δ an area."""
    modulus, interference, give = 1000.0, 1e-3, 2e-6
    parts = (Box("lower", (0, -1), (1, 0), (3, 3)), Box("upper", (0, 0), (1, 1), (2, 2)))
    contact = Contact(
        "upper.y0", against="lower.y1", penalty_parameter=give, interference=interference
    )
    scene = Scene(
        kinematics="plane strain",
        material=(Material(modulus, 0.0),),
        support=(
            Support("lower.y0", {"x": 0, "y": 0}),
            Support("upper.y1", {"x": 0, "y": 0}),
        ),
        contact=(contact,),
        steps=Steps(2),
    )
    result = solved(scene, boxes(parts))
    expected = interference / (2 / modulus + give)
    found = result.quantities
    yield Finding("p of two blocks", found["max_contact_pressure"], expected, 1e-6)
    yield Finding("their work", found["external_work"], 0.5 * expected * interference, 1e-6)


def _press_fit(quick: bool) -> Iterator[Finding]:
    yield from _blocks(quick)
    yield from _long(quick)
    yield from _pushed(quick)


PRESS_FIT_CASES: tuple[Case, ...] = (
    Case(
        "press_fit",
        "a shaft in a tight hub, and pushed through it",
        f"{_LAME}; {_THREAD}",
        _press_fit,
    ),
)


_SOURCE = "the joint diagram (VDI 2230) for bars in series and parallel"
# Bars by x, from the ground at 0: the bolt, and the sleeve with a washer on it.
_BOLT, _SLEEVE, _HEIGHT, _TOP = (0.0, 1.0), (1.5, 3.0), 4.0, 5.0
_E_BOLT, _E_SLEEVE, _E_WASHER = 1000.0, 400.0, 700.0
_GLUE = 1e-6  # ε₁ under the head (length/stress)
_TIGHTENED = 6.0
_PARTS = (
    Box("bolt", (_BOLT[0], 0.0), (_BOLT[1], _TOP), (2, 5)),
    Box("sleeve", (_SLEEVE[0], 0.0), (_SLEEVE[1], _HEIGHT), (3, 4)),
    Box("washer", (_SLEEVE[0], _HEIGHT), (_SLEEVE[1], _TOP), (4, 2)),
)


class Diagram:
    """The joint as springs.

    Attributes:
        bolt: Stiffness of the bolt, k_b (force/length).
        parts: Of what it clamps, k_p (force/length).
        share: Φ.

    Args:
        give: ε₁ between sleeve and washer (length/stress).
    """

    def __init__(self, give: float) -> None:
        self.bolt = (_BOLT[1] - _BOLT[0]) / (_TOP / _E_BOLT + _GLUE)
        compliance = _HEIGHT / _E_SLEEVE + (_TOP - _HEIGHT) / _E_WASHER + give + _GLUE
        self.parts = (_SLEEVE[1] - _SLEEVE[0]) / compliance
        self.share = self.bolt / (self.bolt + self.parts)

    @property
    def separation(self) -> float:
        """The pull F_A at which the parts separate (force)."""
        return _TIGHTENED / (1 - self.share)

    def force(self, pulled: float) -> float:
        """Of the bolt under a pull (force)."""
        return max(_TIGHTENED + self.share * pulled, pulled)

    def work(self, pulled: float) -> float:
        """Of tightening and pulling, below separation (energy)."""
        tightening = 0.5 * _TIGHTENED**2 * (1 / self.bolt + 1 / self.parts)
        return tightening + 0.5 * pulled**2 / (self.bolt + self.parts)


def joint(
    pulled: float, give: float | None, times: tuple[float, ...] = (1.0, 1.5, 2.0)
) -> tuple[Scene, Body]:
    """The joint and its mesh: tightened by time 1, where it is locked, and pulled by time 2.

    Args:
        pulled: F_A at the end (force).
        times: Ends of load steps.
        give: ε₁ between sleeve and washer; None leaves it to the program (length/stress).
    """
    body = boxes(_PARTS)
    ends = [body.groups[f"{part}.y1"] for part in ("bolt", "washer")]
    groups = dict(body.groups) | {"top": Group(1, (*ends[0].tags, *ends[1].tags))}
    head = Obstacle(force=pulled, path=Path(time=(1, 2), factor=(0, -1)))
    moduli = {"bolt": _E_BOLT, "sleeve": _E_SLEEVE, "washer": _E_WASHER}
    scene = Scene(
        kinematics="plane strain",
        material=tuple(Material(modulus, 0.0, on=part) for part, modulus in moduli.items()),
        discretisation=Discretisation(1),
        support=tuple(Support(f"{part}.y0", {"x": 0, "y": 0}) for part in ("bolt", "sleeve")),
        contact=(
            Contact("top", name="head", contact="bonded", obstacle=head, penalty_parameter=_GLUE),
            Contact(
                "sleeve.y1",
                name="seat",
                against="washer.y0",
                penalty_parameter="auto" if give is None else give,
            ),
        ),
        preload=(Preload("bolt", (0, 1), _TIGHTENED, locked_from=1.0),),
        steps=Steps(times=times),
    )
    return scene, dataclasses.replace(body, groups=groups)


def _given(quick: bool) -> Iterator[Finding]:
    """With ε₁ as given, up to separation and beyond."""
    give = 5e-6
    diagram = Diagram(give)
    for share, where in ((0.9, "below separation"), (1.5, "beyond separation")):
        pulled = share * diagram.separation
        # A step that ends where the parts separate leaves nothing of the work open.
        times = (1.0, 1.5, 2.0) if share < 1 else (1.0, 1.5, 1 + 1 / share, 2.0)
        result = solved(*joint(pulled, give, times))
        for step, time in zip(result.steps, times, strict=True):
            label = f", F_A = {(time - 1) * share:.3g} F_V/(1 − Φ)"
            force = step.preloads["bolt"].force
            yield Finding(f"F{label}", force, diagram.force((time - 1) * pulled), 1e-6)
        seat = result.contacts[1].quantities["normal_force"]
        left = diagram.force(pulled) - pulled
        yield Finding(f"force of the seat, {where}", seat, left, 1e-6, absolute=True)
        if share < 1:
            work = result.quantities["external_work"]
            yield Finding(f"external_work, {where}", work, diagram.work(pulled), 1e-6)
        defect = result.checks["energy_balance"].value
        yield Finding(f"energy_balance, {where}", defect, 0.0, 1e-8, absolute=True)


def _automatic(quick: bool) -> Iterator[Finding]:
    """With the program's ε₁, the diagram without any within the error bar."""
    diagram = Diagram(0.0)
    pulled = 0.9 * diagram.separation
    result = solved(*joint(pulled, None))
    found, expected = result.preloads["bolt"], diagram.force(pulled)
    bar = found.errors["force"]["total"]
    assert bar is not None
    yield Finding("F, ε₁ automatic", found.force, expected, bar, absolute=True, bar=bar)
    yield Finding("its bar over F", bar / expected, 0.0, 1e-3, absolute=True)


def _joint(quick: bool) -> Iterator[Finding]:
    yield from _given(quick)
    yield from _automatic(quick)


JOINT_CASES: tuple[Case, ...] = (
    Case("joint", "a bolt tightened, locked, and pulled until the parts separate", _SOURCE, _joint),
)
