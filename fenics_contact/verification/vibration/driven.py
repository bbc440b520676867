"""A case of damping: what is driven, and what the formulas of its joint say of the same forces."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from fenics_contact.analyses.vibration.table import Damping, Modes
from fenics_contact.common.parallel import total
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.studies.study import Study
from fenics_contact.verification.case import Finding, UntrustedError, note_mesh


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
