"""Scenes of ``assemblies.py``: solids that bolts, fits and friction hold together, in mm and N.

Their geometries are in ``assemblies/*.geo``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import Any

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    MeshSource,
    Path,
    Preload,
    Scene,
    Steps,
    Support,
)

FOLDER = FilePath(__file__).resolve().parent / "assemblies"
HELD = {"x": 0, "y": 0, "z": 0}
LATER = Path(time=(1.0, 2.0), factor=(0.0, 1.0))
TIMES = (0.5, 1.0, 1.5, 2.0)


@dataclass(frozen=True)
class Mesh:
    """How a geometry is meshed, and the degree of the displacements; the order is the same."""

    size: float
    curvature: int
    degree: int = 2


def _assembly(geometry: str, mesh: Mesh, parameters: dict[str, float], **keys: Any) -> Scene:
    """A scene of steel parts on a geometry.

    Args:
        geometry: Name of its file.
        mesh: How it is meshed.
        parameters: Of the geometry.
        keys: Of the scene.
    """
    source = MeshSource(
        str(FOLDER / f"{geometry}.geo"),
        order=mesh.degree,
        size=mesh.size,
        curvature=mesh.curvature,
        parameters=parameters,
    )
    of_all = {"material": (Material(210e3, 0.3),), "discretisation": Discretisation(mesh.degree)}
    return Scene(kinematics="3D", mesh=source, **of_all | keys)


def _touching(on: str, against: str, name: str, friction: float, **keys: Any) -> Contact:
    return Contact(
        on, against=against, name=name, friction_coefficient=friction, law="incremental", **keys
    )


def _bolt(on: str, axis: tuple[int, ...], force: float) -> Preload:
    """A bolt that is tightened up to time 1, and keeps its length from then on."""
    return Preload(on, axis, force, locked_from=1.0)


def _twist(moment: float, radius: float) -> tuple[Any, ...]:
    """Traction on a full disc around z with a moment about it."""
    shear = 2 * moment / (3.141592653589793 * radius**3)
    ends = [-radius, radius]
    return (
        {"along": "y", "at": ends, "values": [shear, -shear]},
        {"along": "x", "at": ends, "values": [-shear, shear]},
        0,
    )


def clamp(
    mesh: Mesh, clearance: float = 0.0, friction: float = 0.15, moment: float = 30e3
) -> Scene:
    """A split clamp on a shaft: its bolt is tightened to 8 kN, then the shaft is twisted."""
    contacts = (
        _touching("bore", "journal", "fit", friction),
        _touching("ear_1", "seat_1", "head", friction),
        _touching("ear_0", "seat_0", "nut", friction),
        _touching("hole", "rod", "rod", friction),
    )
    return _assembly(
        "clamp",
        mesh,
        {"clearance": clearance},
        support=(Support("arm_end", HELD),),
        preload=(_bolt("shank", (0, 1, 0), 8e3),),
        load=(Load("shaft_end", traction=_twist(moment, 10 - clearance), path=LATER),),
        contact=contacts,
        steps=Steps(times=TIMES),
    )


def clevis(mesh: Mesh, clearance: float = 0.0, friction: float = 0.15, pull: float = 5e3) -> Scene:
    """A lug that is pulled by its pin in a fork; friction alone keeps the pin from turning."""
    contacts = (
        _touching("lug_bore", "pin_side", "lug", friction),
        _touching("eyes", "pin_side", "fork", friction),
    )
    return _assembly(
        "clevis",
        mesh,
        {"clearance": clearance},
        support=(Support("foot", HELD), Support("pulled", {"y": 0, "z": 0})),
        load=(Load("pulled", traction=(pull / 160, 0, 0)),),
        contact=contacts,
        steps=Steps(number=2),
    )


def flange(mesh: Mesh, bolts: int = 8, friction: float = 0.15, shear: float = 3e3) -> Scene:
    """Two flanges of a tube, pressed together by bolts of 10 kN, then bent and sheared."""
    contacts = (
        _touching("face_1", "face_0", "face", friction),
        _touching("seats_1", "back_1", "heads", friction),
        _touching("seats_0", "back_0", "nuts", friction),
    )
    area = 3.141592653589793 * (26**2 - 20**2)
    return _assembly(
        "flange",
        mesh,
        {"bolts": bolts},
        support=(Support("foot", HELD),),
        preload=tuple(_bolt(f"shank_{number}", (0, 0, 1), 10e3) for number in range(bolts)),
        load=(Load("end", traction=(shear / area, 0, 0), path=LATER),),
        contact=contacts,
        steps=Steps(times=(1.0, 2.0)),
    )


def ball(
    mesh: Mesh, clearance: float = 0.0, friction: float = 0.15, pressure: float = 20.0
) -> Scene:
    """A ball in a socket, pressed down and then a little sideways; contact alone holds it."""
    return _assembly(
        "ball",
        mesh,
        {"clearance": clearance, "lowered": clearance},
        support=(Support("foot", HELD),),
        load=(
            Load("top", traction=(0, 0, -pressure)),
            Load("top", traction=(0.02 * pressure, 0, 0), path=LATER),
        ),
        contact=(_touching("round", "hollow", "socket", friction),),
        steps=Steps(times=(1.0, 2.0)),
    )


def stack(
    mesh: Mesh, plates: int = 10, gap: float = 0.0, friction: float = 0.2, shear: float = 0.1
) -> Scene:
    """Plates on each other, pressed together and sheared by less than friction holds."""
    top = f"high_{plates - 1}"
    contacts = tuple(
        _touching(f"low_{number + 1}", f"high_{number}", f"{number}", friction)
        for number in range(plates - 1)
    )
    return _assembly(
        "stack",
        mesh,
        {"plates": plates, "gap": gap},
        support=(Support("low_0", HELD),),
        load=(
            Load(top, traction=(0, 0, -10)),
            Load(top, traction=(10 * shear, 0, 0), path=LATER),
        ),
        contact=contacts,
        steps=Steps(times=(1.0, 2.0)),
    )


@dataclass(frozen=True)
class Case:
    """An assembly to solve.

    Attributes:
        name: Of it.
        make: Makes its scene.
        applies: Whether S is applied and not formed, however few jumps there are.
    """

    name: str
    make: Callable[[], Scene]
    applies: bool = False


CASES = (
    Case("clamp on a shaft", lambda: clamp(Mesh(8, 16))),
    Case("lug and pin, clearance .02", lambda: clevis(Mesh(6, 16), 0.02)),
    Case("lug and pin, no clearance", lambda: clevis(Mesh(6, 16))),
    Case("flange, 4 bolts", lambda: flange(Mesh(20, 12), 4)),
    Case("ball in a socket", lambda: ball(Mesh(5, 16), 0.01)),
    Case("ten plates", lambda: stack(Mesh(5, 3))),
)
QUICK = (
    Case("clamp on a shaft, P1", lambda: clamp(Mesh(8, 12, 1))),
    Case("lug and pin, P1", lambda: clevis(Mesh(8, 12, 1), 0.02)),
    Case("flange, 2 bolts, P1", lambda: flange(Mesh(12, 10, 1), 2)),
    Case("ball in a socket, P1", lambda: ball(Mesh(6, 12, 1), 0.01)),
    Case("three plates", lambda: stack(Mesh(10, 3), 3)),
)
# Without S, to compare memory with its estimate: the first two also have another way.
LARGE = (
    Case("flange, 4 bolts, without S", lambda: flange(Mesh(20, 12), 4), True),
    Case("flange, 8 bolts, without S", lambda: flange(Mesh(20, 12)), True),
    Case("flange, 8 bolts, fine cells", lambda: flange(Mesh(8, 20))),
)
# So large that CalculiX solves each in a minute or two.
BESIDE = (
    Case("lug and pin beside CalculiX", lambda: clevis(Mesh(8, 12), 0.02)),
    Case("ball beside CalculiX", lambda: ball(Mesh(6, 12), 0.01)),
    Case("three plates beside CalculiX", lambda: stack(Mesh(10, 3), 3)),
)
