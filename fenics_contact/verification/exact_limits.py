"""The exact answers of scenes of all kinds, as the limit of smaller and smaller parameters.

With ε₁ alone, and with ε alone, the answer differs from the exact one in proportion to the
parameter: a tenth of it leaves a tenth, and a hundredth a hundredth.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from typing import Any

from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.laws.friction_laws import OrthotropicFriction
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Discretisation, Scene, SolverSettings
from fenics_contact.scene.settings import Steps
from fenics_contact.scene.values import Path
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Case, Finding, solved

_DEPTH = 0.01
# Parameters, over the largest of a scene.
_SHARES = (1.0, 0.1, 0.01)
# What differences over those of a tenth may be off by: they have terms of higher order.
_TOLERANCE = 0.05
_SETTINGS = SolverSettings(errors="none", exact_check=False, tolerance=1e-12)
_PENALTY, _SMOOTHING = "penalty_parameter", "regularisation_parameter"
# Load steps that come in, go on along the surface and halfway back.
_TO_AND_FRO = Path(time=(0.0, 0.5, 0.8, 1.0), factor=(0.0, 0.0, 1.0, 0.5))


@dataclasses.dataclass(frozen=True)
class LimitScene:
    """A scene without penalty and smoothing.

    Attributes:
        name: What is special about it.
        scene: The scene.
        body: Its mesh.
        parameters: Those that its first contact has.
        largest: What they are at most (length/stress; length).
    """

    name: str
    scene: Scene
    body: Callable[[], Body]
    parameters: tuple[str, ...] = (_PENALTY, _SMOOTHING)
    largest: float = 1e-7


def _block(cells: int = 4) -> Body:
    return boxes([Box("block", (0, 0), (1, 1), (cells, cells))])


def _cube() -> Body:
    return boxes([Box("block", (0, 0, 0), (1, 1, 1), (2, 2, 2))], cell="hexahedron")


def _pair(cells: int) -> Callable[[], Body]:
    return lambda: boxes(
        [Box("block", (0, 0), (1, 1), (4, 4)), Box("floor", (-0.5, -1), (2, 1), (cells, 3))]
    )


def _scene(**given: Any) -> Scene:
    """A block, held and moved at its top."""
    known: dict[str, Any] = {
        "kinematics": "plane strain",
        "material": (Material(1000.0, 0.3),),
        "support": (Support("block.y1", {"x": 0.4 * _DEPTH, "y": -0.4 * _DEPTH}),),
        "solver": _SETTINGS,
    }
    return Scene(**(known | given))


def _contact(coefficient: float = 0.35, **given: Any) -> Contact:
    known: dict[str, Any] = {"on": "block.y0", _PENALTY: 0, _SMOOTHING: 0}
    return Contact(friction_coefficient=coefficient, **(known | given))


def _moved(x: float, y: float) -> tuple[Support, ...]:
    return (Support("block.y1", {"x": x * _DEPTH, "y": y * _DEPTH}),)


_STILL = _moved(0.0, 0.0)
_ROUND: dict[str, Any] = {"shape": "parabola", "radius": 20.0, "position": (0.5, 0.0)}


def in_the_plane() -> Iterator[LimitScene]:
    """Scenes of one block in the plane."""
    for coefficient in (0.2, 0.35, 0.6):
        found = _scene(contact=(_contact(coefficient),), support=_moved(0.1, -0.4))
        yield LimitScene(f"coefficient {coefficient:g}", found, _block)
    found = _scene(contact=(_contact(),), support=_moved(-0.3, -0.5))
    yield LimitScene("moved the other way", found, _block)
    found = _scene(contact=(_contact(),), support=_moved(0.02, -0.5))
    yield LimitScene("mostly pressed", found, _block)
    found = _scene(contact=(_contact(),), kinematics="plane stress")
    yield LimitScene("plane stress", found, _block)
    found = _scene(contact=(_contact(),), discretisation=Discretisation(1))
    yield LimitScene("linear elements", found, _block)
    found = _scene(contact=(_contact(),), material=(Material(1000.0, 0.0),))
    yield LimitScene("without lateral strain", found, _block)
    found = _scene(contact=(_contact(0.0),))
    yield LimitScene("without friction", found, _block, (_PENALTY,))
    given = Contact("block.y0", pressure=5.0, friction_coefficient=0.3, regularisation_parameter=0)
    held = (Support("block.y1", {"x": 0.4 * _DEPTH, "y": 0}),)
    yield LimitScene(
        "given pressure", _scene(contact=(given,), support=held), _block, (_SMOOTHING,)
    )


def under_obstacles() -> Iterator[LimitScene]:
    """Scenes with obstacles that have a shape, or that forces drive, and with loads."""
    obstacle = Obstacle(indentation=_DEPTH, **_ROUND)
    yield LimitScene(
        "parabola", _scene(contact=(_contact(obstacle=obstacle),), support=_STILL), _block
    )
    obstacle = dataclasses.replace(obstacle, displacement=(0.3 * _DEPTH, 0.0))
    found = _scene(contact=(_contact(obstacle=obstacle),), support=_STILL)
    yield LimitScene("parabola that moves along", found, _block)
    obstacle = Obstacle(force=3.0, **_ROUND)
    found = _scene(contact=(_contact(obstacle=obstacle),), support=_STILL)
    yield LimitScene("parabola under a force", found, _block)
    loads = (Load("block.y1", pressure=10.0), Load("block.y1", traction=(2.0, 0.0)))
    found = _scene(contact=(_contact(0.4),), support=(), load=loads)
    yield LimitScene("held by friction alone", found, _block)
    obstacle = Obstacle(indentation=_DEPTH, shape="paraboloid", radius=20.0)
    held = (Support("block.y1", {"x": 0, "y": 0}), Support("block.x0", {"x": 0}))
    found = _scene(kinematics="axisymmetric", contact=(_contact(obstacle=obstacle),), support=held)
    yield LimitScene("axisymmetric", found, _block)


def of_other_kinds() -> Iterator[LimitScene]:
    """Scenes with load steps, of two bodies, and in space."""
    obstacle = Obstacle(
        indentation=_DEPTH,
        path=Path(time=(0.0, 0.5, 1.0), factor=(0.0, 1.0, 1.0)),
        displacement=(0.3 * _DEPTH, 0.0),
        displacement_path=_TO_AND_FRO,
        **_ROUND,
    )
    contact = _contact(obstacle=obstacle, law="incremental")
    found = _scene(contact=(contact,), support=_STILL, steps=Steps(number=10))
    yield LimitScene("to and fro in 10 load steps", found, _block)
    floor = Support("floor.y0", {"x": 0, "y": 0})
    for words, cells in (("whose meshes match", 8), ("whose meshes do not match", 7)):
        contact = _contact(against="floor.y1")
        found = _scene(contact=(contact,), support=(*_moved(0.4, -0.4), floor))
        yield LimitScene(f"two bodies {words}", found, _pair(cells), largest=1e-6)
    moved: dict[Any, Any] = {"x": 0.3 * _DEPTH, "y": 0.2 * _DEPTH, "z": -0.4 * _DEPTH}
    given: dict[str, Any] = {"kinematics": "3D", "support": (Support("block.z1", moved),)}
    contact = _contact(on="block.z0")
    yield LimitScene("in space", _scene(contact=(contact,), **given), _cube)
    law = OrthotropicFriction(kind="orthotropic", direction=(1, 0, 0), along=0.35, across=0.2)
    contact = _contact(0.0, on="block.z0", friction_law=law)
    yield LimitScene("orthotropic", _scene(contact=(contact,), **given), _cube)


def limit_scenes() -> Iterator[LimitScene]:
    """All of them."""
    yield from in_the_plane()
    yield from under_obstacles()
    yield from of_other_kinds()


def orders(one: LimitScene) -> Iterator[Finding]:
    """Differences from the exact answer, over those of a tenth of the parameter; collective.

    Args:
        one: The scene.
    """
    body, contact = one.body(), one.scene.contact[0]

    def energy(**given: Any) -> float:
        other = dataclasses.replace(contact, **given)
        result = solved(dataclasses.replace(one.scene, contact=(other,)), body)
        return float(result.quantities["strain_energy"])

    exact = energy()
    words = {_PENALTY: "ε₁", _SMOOTHING: "ε"}
    for parameter in one.parameters:
        others = {name: 0.0 for name in one.parameters if name != parameter}
        found = [energy(**others, **{parameter: share * one.largest}) - exact for share in _SHARES]
        for share, first, second in (
            ("tenth", found[0], found[1]),
            ("hundredth", found[1], found[2]),
        ):
            said = f"{one.name}: difference by {words[parameter]}, over that of a {share}"
            ratio = first / second if second else float("nan")
            yield Finding(said, ratio, 10.0, _TOLERANCE)


# Names of those that are quick.
_QUICK = ("coefficient 0.35", "parabola under a force", "two bodies whose meshes match")


def _limits(quick: bool) -> Iterator[Finding]:
    for one in limit_scenes():
        if not quick or one.name in _QUICK:
            yield from orders(one)


EXACT_LIMIT_CASES: tuple[Case, ...] = (
    Case(
        "exact_limits",
        "contact and friction without penalty and smoothing, as the limit of both in 20 scenes",
        "convergence of order one in ε₁ alone, and in ε alone",
        _limits,
    ),
)
