"""The paper's slabs: example 1 (prescribed pressure) and 2 (Winkler foundation).

Parts of the examples' data are lost in the paper; they are reconstructed as the meshes and the
numbers below say. The references are those of a separate FEniCSx prototype of the same data.
"""

from __future__ import annotations

from collections.abc import Iterator

from fenics_contact.common.program import mesh_file
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load, Support
from fenics_contact.scene.scene import MeshSource, Scene
from fenics_contact.verification.case import Case, Finding, of_quantity, solved

# End load → position of the last contact point that sticks, on 16 × 1 elements.
_LAST_STICKING = {100.0: 8.0, 200.0: 7.75, 300.0: 6.25, 400.0: 5.25, 600.0: 3.0, 700.0: 1.75}
# Stiffness of the foundation → deflection in the middle, on 160 × 16 elements.
_DEFLECTION = {100.0: 0.0718, 20.0: 0.2578, 1000.0: 0.00968}
_CONTACT_END = 2.36  # at a stiffness of 100
_LOAD = 10.0

_PAPER = "L. T. Campos, J. T. Oden, N. Kikuchi, CMAME 34 (1982) 821-845"
_PROTOTYPE = "data reconstructed; values of a separate prototype"


def slab_scene(end_load: float = 300.0, cells: tuple[int, int] = (16, 1)) -> Scene:
    """Example 1: a slab pushed at its end against friction under a given pressure.

    Args:
        end_load: Pressure on its right end (stress).
        cells: Along and across.
    """
    return Scene(
        kinematics="plane stress",
        mesh=(
            MeshSource(
                mesh_file("slab.geo"),
                cell="quadrilateral",
                parameters={"cells_along": cells[0], "cells_across": cells[1]},
            ),
        ),
        material=(Material(1000, 0.3),),
        support=(Support("bottom", {"y": 0}), Support("left", {"x": 0})),
        load=(Load("right", traction=(-end_load, 0)),),
        contact=(Contact("top", pressure=300, friction_coefficient=0.3),),
    )


def _slab(quick: bool) -> Iterator[Finding]:
    for end_load, expected in _LAST_STICKING.items():
        result = solved(slab_scene(end_load))
        if end_load == 300.0:
            quantities = result.quantities
            for quantity, reference in (("friction_force", 209.98), ("reaction", 90.02)):
                value = quantities[quantity][0]
                yield Finding(f"{quantity} x", value, reference, 0.1, absolute=True)
        label = f"last sticking point, end load {end_load:g}"
        yield Finding(label, _last_sticking(result), expected, 1e-9, absolute=True)


def _last_sticking(result: Result) -> float:
    """Position of the last contact point that sticks (length)."""
    points = result.points
    assert points is not None
    return float(points.coordinates[points.status == "STICK", 0].max(initial=0.0))


def winkler_scene(stiffness: float) -> Scene:
    """Example 2 without friction: half a slab on springs, with a patch of pressure on top."""
    return Scene(
        kinematics="plane stress",
        mesh=(
            MeshSource(
                mesh_file("foundation_slab.geo"),
                cell="quadrilateral",
                parameters={"cells_along": 160, "cells_across": 16},
            ),
        ),
        material=(Material(1000, 0.3),),
        symmetry=("left",),
        load=(Load("patch", traction=(0, -_LOAD)),),
        contact=(Contact("bottom", foundation_stiffness=stiffness),),
    )


def _winkler(quick: bool) -> Iterator[Finding]:
    deflections = {100.0: _DEFLECTION[100.0]} if quick else _DEFLECTION
    for stiffness, expected in deflections.items():
        result = solved(winkler_scene(stiffness))
        assert result.points is not None
        yield Finding(f"w(0), k = {stiffness:g}", -float(result.points.gap[0]), expected, 1e-2)
        if stiffness == 100.0:
            end = result.quantities["contact_area"]
            yield Finding("contact end, k = 100", end, _CONTACT_END, 0.05, absolute=True)
            yield of_quantity(result, "normal_force", _LOAD, 1e-6, ", k = 100")


CASES: tuple[Case, ...] = (
    Case("slab", "slab with friction", f"{_PAPER}, example 1; {_PROTOTYPE}", _slab),
    Case("winkler", "slab on a Winkler foundation", f"{_PAPER}, example 2; {_PROTOTYPE}", _winkler),
)
