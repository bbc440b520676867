"""Contact that is lost, just made, or made from afar."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from functools import partial
from typing import Any, Literal

import numpy as np

from fenics_contact.common.parallel import smallest
from fenics_contact.results.result import Result
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Scene, Steps
from fenics_contact.scene.values import Path
from fenics_contact.verification.case import Finding
from fenics_contact.verification.hard.case import HardCase, Trials
from fenics_contact.verification.hard.scenes import (
    ASIDE,
    CLAMPED,
    NU,
    ROLLER,
    STATICS,
    E,
    box,
    driven_body,
    plane_scene,
    pressed_scene,
    with_contact,
)
from fenics_contact.verification.published.indenters import HERTZ, JOHNSON, RADIUS, half_space_scene

_THEME = "Loss of contact and just touching"
_HEIGHT = 2.0
_DOWN = Load("top", traction=(0, -10))
_UP = Load("top", traction=(0, 10))


def _body() -> Any:
    return box((6, 8), (1, _HEIGHT))


def _plane(height: float, **keys: Any) -> Obstacle:
    return Obstacle("plane", position=(0, height), **keys)


def _refused(scene: Scene, trials: Trials) -> Iterator[Finding]:
    """There is no answer to compare."""
    trials.solve(scene, _body())
    yield from ()


def _nothing(scene: Scene, trials: Trials) -> Iterator[Finding]:
    """No force anywhere, to round-off of E times the area."""
    quantities = trials.solve(scene, _body()).quantities
    for key in ("normal_force", "max_contact_pressure"):
        yield Finding(f"{key} / E", quantities[key] / E, 0.0, 1e-12, absolute=True)
    energy = quantities["strain_energy"] / E
    yield Finding("strain_energy / E", energy, 0.0, 1e-15, absolute=True)


def _falling(trials: Trials) -> Iterator[Finding]:
    """A body above the floor, pressed down: it must be brought to it, however far."""
    gap, force = 0.5, 10.0
    scene = plane_scene(Contact("bottom", obstacle=_plane(-gap)), (ASIDE,), (_DOWN,))
    run, result = trials.solve_keeping(scene, _body())
    yield Finding("normal_force", result.quantities["normal_force"], force, 1e-9)
    assert run.solution is not None
    lowest = run.problem.spaces.coordinates[:, 1] < 1e-9
    fallen = smallest(run.problem.comm, -run.solution.displacement[lowest, 1])
    yield Finding("how far it fell", fallen, gap, 1e-5)


def _plate(gap: float, force: float, trials: Trials) -> Iterator[Finding]:
    """A plate that a force drives down from afar onto a body that may widen: uniaxial stress."""
    scene = plane_scene(
        Contact("top", obstacle=_plane(_HEIGHT + gap, force=force)), (ROLLER, ASIDE)
    )
    result = trials.solve(scene, _body())
    points = result.points
    assert points is not None
    worst = float(np.abs(points.contact_pressure / force - 1).max())
    yield Finding("pressure error", worst, 0.0, 1e-3, absolute=True)
    expected = gap + force * _HEIGHT * (1 - NU**2) / E
    yield Finding("indentation", result.quantities["indentation"], expected, 1e-3)


def _from_afar(trials: Trials) -> Iterator[Finding]:
    """A paraboloid that starts 5 radii of the contact away, and is driven by Hertz's force."""
    distance = 5 * HERTZ.radius
    obstacle = Obstacle("paraboloid", radius=RADIUS, force=HERTZ.force, position=(0, distance))
    quantities = trials.solve(half_space_scene(obstacle)).quantities
    yield Finding("max_contact_pressure", quantities["max_contact_pressure"], HERTZ.peak, 2e-3)
    yield Finding("indentation − distance", quantities["indentation"] - distance, 1.0, 2e-3)


def _path(factors: tuple[float, ...]) -> dict[str, Any]:
    times = tuple(float(number) for number in range(len(factors)))
    return {"path": Path(time=times, factor=factors)}


def _final(scene: Scene, factors: tuple[float, ...], trials: Trials) -> Result:
    obstacle = scene.contact[0].obstacle
    assert obstacle is not None
    moved = with_contact(scene, obstacle=dataclasses.replace(obstacle, **_path((0.0, *factors))))
    steps = Steps(times=tuple(float(number + 1) for number in range(len(factors))))
    return trials.solve(dataclasses.replace(moved, steps=steps), driven_body())


def _compared(found: Result, direct: Result) -> Iterator[Finding]:
    """All points of two runs on the same mesh."""
    assert found.points is not None and direct.points is not None
    for key in ("contact_pressure", "friction_traction"):
        ours, other = getattr(found.points, key), getattr(direct.points, key)
        peak = float(np.abs(direct.points.contact_pressure).max())
        yield Finding(f"{key} / peak", float(np.abs(ours - other).max()) / peak, 0, 1e-7, True)


def _no_memory(trials: Trials) -> Iterator[Finding]:
    """The static law after more load and back against the load at once."""
    scene = pressed_scene(coefficient=0.4, regularisation_parameter=1e-7)
    direct = _final(scene, (1.0,), trials)
    yield from _compared(_final(scene, (1.0, 2.0, 1.0), trials), direct)


def _comes_again(law: Literal["static", "incremental"], trials: Trials) -> Iterator[Finding]:
    """What left the body without a trace presses it again as for the first time."""
    scene = pressed_scene(coefficient=0.4, law=law, regularisation_parameter=1e-7)
    direct = _final(scene, (1.0,), trials)
    again = _final(scene, (1.0, -1.0, 1.0), trials)
    between = again.steps[1]["quantities"]["normal_force"]
    yield Finding("normal_force while away", between, 0.0, 1e-9, absolute=True)
    yield from _compared(again, direct)


def _light(force: float, trials: Trials) -> Iterator[Finding]:
    """The force is met, and the supports carry it."""
    obstacle = Obstacle("parabola", radius=4, position=(0.5, _HEIGHT), force=force)
    quantities = trials.solve(
        plane_scene(Contact("top", obstacle=obstacle), (CLAMPED,)), _body()
    ).quantities
    yield Finding("normal_force", quantities["normal_force"], force, 1e-8)
    yield Finding("reaction y", quantities["reaction"][1], force, 1e-6)


_HELD = plane_scene(Contact("top", obstacle=_plane(_HEIGHT)), (CLAMPED,))
_APEX = Obstacle("parabola", radius=4, position=(0.5, _HEIGHT))
_AWAY = "the loads push it away"
SEPARATION_CASES: tuple[HardCase, ...] = (
    HardCase(
        "pulled_off",
        _THEME,
        "a force pulls the body off the floor",
        STATICS,
        partial(_refused, plane_scene(Contact("bottom"), (ASIDE,), (_UP,))),
        ("refused",),
        _AWAY,
    ),
    HardCase(
        "pulled_off_rough",
        _THEME,
        "the same with friction, nothing else holds it",
        STATICS,
        partial(_refused, plane_scene(Contact("bottom", friction_coefficient=1), (), (_UP,))),
        ("refused",),
        _AWAY,
    ),
    HardCase(
        "unloaded",
        _THEME,
        "a body that lies on the floor under no load",
        STATICS,
        partial(_refused, plane_scene(Contact("bottom"), (ASIDE,))),
        ("refused",),
        "nothing presses it",
    ),
    HardCase(
        "clearance",
        _THEME,
        "between floor and ceiling with clearance, a load from the side",
        STATICS,
        partial(
            _refused,
            plane_scene(
                (
                    Contact("bottom", obstacle=_plane(-0.1)),
                    Contact("top", obstacle=_plane(_HEIGHT + 0.1)),
                ),
                (ASIDE,),
                (Load("right", traction=(-5, 0)),),
            ),
        ),
        ("refused",),
        "clearance between its obstacles",
    ),
    HardCase("falling", _THEME, "a body half its width above the floor", STATICS, _falling),
    HardCase(
        "plate_from_afar",
        _THEME,
        "a plate under force, 0.1 above the body",
        "uniaxial stress",
        partial(_plate, 0.1, 10.0),
    ),
    HardCase(
        "plate_from_far_afar",
        _THEME,
        "a plate under force, 50 heights above the body",
        "uniaxial stress",
        partial(_plate, 100.0, 10.0),
    ),
    HardCase(
        "paraboloid_from_afar",
        _THEME,
        "a paraboloid under force, 5 contact radii above",
        f"{JOHNSON}, (4.22)-(4.24)",
        _from_afar,
    ),
    HardCase(
        "just_touching_plane",
        _THEME,
        "a plane that just touches",
        "nothing presses: no force",
        partial(_nothing, _HELD),
    ),
    HardCase(
        "just_touching_rough",
        _THEME,
        "the same with friction",
        "nothing presses: no force",
        partial(_nothing, with_contact(_HELD, friction_coefficient=0.5)),
    ),
    HardCase(
        "just_touching_apex",
        _THEME,
        "a parabola that just touches",
        "nothing presses: no force",
        partial(_nothing, plane_scene(Contact("top", obstacle=_APEX), (CLAMPED,))),
    ),
    HardCase(
        "stays_away",
        _THEME,
        "an obstacle that stops short of the body",
        "nothing presses: no force",
        partial(_nothing, with_contact(_HELD, obstacle=_plane(_HEIGHT + 1, indentation=0.5))),
    ),
    HardCase(
        "zero_force",
        _THEME,
        "a force of zero on the obstacle",
        "nothing presses: no force",
        partial(
            _nothing,
            with_contact(_HELD, obstacle=dataclasses.replace(_APEX, force=0.0)),
        ),
    ),
    HardCase(
        "light_force", _THEME, "a force of 1e-11 E on a parabola", STATICS, partial(_light, 1e-8)
    ),
    HardCase("heavy_force", _THEME, "a force of E/10 on a parabola", STATICS, partial(_light, 1e2)),
    HardCase(
        "static_unloading",
        _THEME,
        "static law, pressed, pressed twice as deep, and back",
        "the static law has no memory: the same at once",
        _no_memory,
    ),
    HardCase(
        "comes_again_static",
        _THEME,
        "static law, an obstacle that leaves and comes again",
        "no memory: the same at once",
        partial(_comes_again, "static"),
    ),
    HardCase(
        "comes_again",
        _THEME,
        "incremental law, an obstacle that leaves and comes again",
        "a free body has no memory: the same at once",
        partial(_comes_again, "incremental"),
    ),
)
