"""The joint diagram: a bolt is tightened to F_V, locked, and pulled at its head by F_A.

F = F_V + Φ F_A with Φ = k_b/(k_b + k_p), until the parts separate at F_V/(1 − Φ); then F = F_A.
Bolt and parts are bars of ν = 0 between the ground and a rigid head, glued on top of them. What the
penalties ε₁ of glue and contact give are springs ε₁/A in series with the bars.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

from fenics_contact.mesh.tagged_mesh import Body, Group
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Preload, Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Discretisation, Scene, Steps
from fenics_contact.scene.values import Path
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Case, Finding, solved

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


CASES: tuple[Case, ...] = (
    Case("joint", "a bolt tightened, locked, and pulled until the parts separate", _SOURCE, _joint),
)
