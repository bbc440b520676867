"""Derivatives of the data of a problem by a number of its scene, at a pseudo-time.

Where the answer is proportional to it, that of a unit; else by a complex step of the formula that
the problem itself goes by. Automatic ε and ε₁, sizes of load steps, and what faces what of two
bodies are held.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from fenics_contact.body.elasticity import Isotropic
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.contact.against_obstacle import ObstacleKinematics
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.point_gradients import GivenChange
from fenics_contact.contact.rigid_obstacle import DIRECTIONS
from fenics_contact.problem.loads import load_of_components
from fenics_contact.problem.loads.couplings import PointMotion
from fenics_contact.problem.loads.temperatures import ThermalStrain
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.scalar_kinds import Resultant, Shortening
from fenics_contact.problem.scalar_unknown import BodyScalar
from fenics_contact.scene.loading.heat import Conductance
from fenics_contact.scene.loading.load_kinds import slope_of
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.values import AXES, Value
from fenics_contact.simulation.sensitivities.heat_adjoint import HeatGradient
from fenics_contact.simulation.sensitivities.scene_values import found_in, numbered, value_under

_OF_PROFILES = "of a profile, only the values have"
_MODULI = ("youngs_modulus", "poissons_ratio")
# Why numbers have none that answers do follow.
_WHY = {
    "mesh": "cells would be others, from which answers jump more than they change; compare runs",
    "thickness": "where it varies, stresses follow it; one that is a number has",
}


@dataclass(frozen=True, eq=False)
class Change:
    """How what a problem is given changes with a number of its scene.

    Attributes:
        load: Nodal forces, (nodes, components); None where they do not change.
        prescribed: Displacements of ``Problem.constrained``; likewise.
        contacts: Number of a contact → what it is given.
        scalars: Number of a scalar unknown → the right-hand side of its equation.
        held: Number of a scalar of the body → the value that it is held at.
        columns: Number of a scalar unknown → its column of the far field.
        modulus: Number of a material and name of its modulus, if it is one.
        springs: Number of a foot of ``Problem.feet`` → how forces of its springs on the body
            change with a displacement of the body, (nodes, components); collective.
        of_resultants: What forces and energies change by, over themselves, with all else the same.
        heat: The derivative that a gradient in what conduction is given has by it; collective.
    """

    load: Array | None = None
    prescribed: Array | None = None
    contacts: Mapping[int, GivenChange] = field(default_factory=dict)
    scalars: Mapping[int, float] = field(default_factory=dict)
    held: Mapping[int, float] = field(default_factory=dict)
    columns: Mapping[int, Array] = field(default_factory=dict)
    modulus: tuple[int, str] | None = None
    springs: Mapping[int, Callable[[Array], Array]] = field(default_factory=dict)
    of_resultants: float = 0.0
    heat: Callable[[HeatGradient], float] | None = None

    def added(self, other: Change) -> Change:
        """Return the sum with another change, of supports and of scalars alone."""
        moved = [one.prescribed for one in (self, other) if one.prescribed is not None]
        scalars = dict(self.scalars)
        for place, value in other.scalars.items():
            scalars[place] = scalars.get(place, 0.0) + value
        prescribed = np.sum(moved, axis=0) if moved else None
        return replace(self, prescribed=prescribed, scalars=scalars)

    def times(self, factor: float) -> Change:
        """Return a multiple of the change, of supports and of scalars alone."""
        moved = None if self.prescribed is None else factor * self.prescribed
        return Change(prescribed=moved, scalars={n: factor * v for n, v in self.scalars.items()})


class SceneChanges:
    """Changes by the keys of a scene; collective.

    Args:
        problem: Of the scene, in the state at the pseudo-time.
        time: The pseudo-time.
    """

    def __init__(self, problem: Problem, time: float) -> None:
        self.problem, self.time = problem, time

    def by(self, key: str) -> Change:
        """Return the change of the problem's data with a number; collective.

        Args:
            key: As of ``--set``, such as ``contact.0.friction_coefficient``.

        Raises:
            InputError: There is no such number, or it has no derivative.
        """
        value = found_in(self.problem.scene, key)
        if value == "auto":
            raise _refused(key, "it is chosen automatically, and held")
        if isinstance(value, bool) or not isinstance(value, float | int):
            raise _refused(key, "it is no number")
        if key == "thickness":
            return self._of_thickness(float(value))
        group, number, *rest = [*numbered(self.problem.scene, key).split("."), "", ""]
        rest = [name for name in rest if name]
        kinds = {
            "contact": self._of_contact,
            "load": self._of_load,
            "support": self._of_support,
            "preload": self._of_preload,
            "coupling": self._of_coupling,
            "spring": self._of_joint,
            "temperature": self._of_temperature,
            "material": self._of_material,
            "heat": self._of_heat,
        }
        if group not in kinds:
            raise _refused(
                key, _WHY.get(group, "answers do not follow it smoothly, or not by itself")
            )
        return kinds[group](key, int(number), rest)

    def _of_thickness(self, thickness: float) -> Change:
        """Stresses are those of forces that are so many times smaller, where forces are given."""
        if self.problem.is_sprung:
            raise _refused("thickness", "not beside springs, whose stiffness it changes not")
        found = Change(of_resultants=1 / thickness)
        for number, preload in enumerate(self._shortenings):
            own = self._of_preload(f"preload.{number}.force", number, ["force"])
            found = found.added(own.times(-preload.scene.force / thickness))
        forces = {self.problem.unknowns.index(one): one.own_force for one in self._motions}
        given = Change(scalars={n: -force / thickness for n, force in forces.items() if force})
        found = found.added(given)
        for number, contact in enumerate(self.problem.contacts):
            if contact.has_unknown_position:
                obstacle = contact.contact.obstacle
                assert obstacle is not None and obstacle.force is not None
                own = self._of_force(number, contact)
                found = found.added(own.times(-obstacle.force / thickness))
        return found

    def _of_load(self, key: str, number: int, rest: list[str]) -> Change:
        problem, load = self.problem, self.problem.scene.load[number]
        if rest[0] == "path":
            raise _refused(key, "it is part of a path")
        slopes = load.slopes(rest)
        if slopes is None:
            raise _refused(key, _OF_PROFILES)
        unit = load_of_components(load, slopes, f"load[{number}]", problem.load_site)
        if unit is None:  # it acts beyond the body alone
            return Change()
        nodal = unit.acting.nodal_of_units(problem.discrete.found.setdefault("loads", {}))
        share = unit.path(self.time)
        weights = {
            problem.unknowns.index(one): share * weight
            for one in self._motions
            if (weight := one.weight_of(unit.acting.acceleration_at)) and not one.is_locked
        }
        return Change(load=share * nodal, scalars=weights)

    def _of_support(self, key: str, number: int, rest: list[str]) -> Change:
        problem, support = self.problem, self.problem.scene.support[number]
        if support.is_elastic and rest[0] != "path":
            return self._of_springs(key, number, rest)
        if support.rotation is not None and rest == ["rotation", "angle"]:
            unit_turn = replace(support.rotation, angle=1.0)
            found = problem.supports.rotation_slopes(number, unit_turn, self.time)
            return Change(prescribed=self._at_constrained(problem.supports.dofs, found))
        if rest[0] == "rotation":
            raise _refused(key, "of a support's rotation, the angle has")
        if rest[0] != "displacement":
            raise _refused(key, "it is part of a path")
        axis = next(axis for axis in AXES if axis == rest[1])
        unit = _unit(key, support.displacement[axis], rest[2:])
        found = problem.supports.slopes(number, axis, unit, self.time)
        return Change(prescribed=self._at_constrained(problem.supports.dofs, found))

    def _of_springs(self, key: str, number: int, rest: list[str]) -> Change:
        """The change by the stiffness of springs, or by the displacement of their foot."""
        support, feet = self.problem.scene.support[number], self.problem.feet
        place = next(n for n, foot in enumerate(feet) if foot.springs.support == number)
        foot, size = feet[place], self.problem.spaces.components
        key_of_foot = ".".join(rest[:2]) if rest[0] == "displacement" else rest[0]
        if key_of_foot in (known := support.feet(size)):
            way, value = known[key_of_foot]
            unit = _unit(key, value, rest[len(key_of_foot.split(".")) :])
            load = foot.path(self.time) * foot.springs.pull(foot.moved(way, unit, key))
            return Change(springs={place: lambda moved: load})
        if foot.springs.directions is not None:
            raise _refused(key, "of a support with axes of its own, the displacement has")
        share = np.zeros(size)
        for axis, value in support.sprung(size).items():
            if rest[1:] in ([], [axis]):
                share[AXES.index(axis)] = 1 / value
        return Change(springs={place: lambda moved: share * foot.forces(moved)})

    def _at_constrained(self, dofs: Integers, values: Array) -> Array:
        """Values at all dofs that are constrained, 0 at others."""
        found = np.zeros(len(self.problem.constrained))
        found[np.searchsorted(self.problem.constrained, dofs)] = values
        return found

    def _of_preload(self, key: str, number: int, rest: list[str]) -> Change:
        problem = self.problem
        if rest != ["force"]:
            raise _refused(key, "the body depends on it")
        preload = self._shortenings[number]
        return Change(scalars={problem.unknowns.index(preload): preload.force_factor(self.time)})

    def _of_coupling(self, key: str, number: int, rest: list[str]) -> Change:
        """The change by a component of a coupling's force or moment."""
        problem, coupling = self.problem, self.problem.scene.coupling[number]
        kinds = {"force": "displacement", "moment": "rotation"}
        if rest[0] not in kinds:
            raise _refused(key, "of a coupling, the force and the moment have")
        axis = AXES[int(rest[1])] if rest[1:] else "z"
        found = {
            problem.unknowns.index(one): one.force_factor(self.time)
            for one in self._motions
            if one.scene is coupling and one.way == (kinds[rest[0]], axis) and not one.is_locked
        }
        return Change(scalars=found)

    def _of_joint(self, key: str, number: int, rest: list[str]) -> Change:
        """The change by a stiffness of springs between couplings."""
        problem, spring = self.problem, self.problem.scene.spring[number]
        kinds = {"stiffness": "displacement", "rotational_stiffness": "rotation"}
        if rest[0] not in kinds:
            raise _refused(key, "of springs, the stiffness has")
        ways = [
            way
            for way in spring.by_way(problem.spaces.kinematics)
            if way[0] == kinds[rest[0]] and rest[1:] in ([], [way[1]])
        ]
        joint = problem.discrete.description.joints[number]
        unit = problem.elastic.joined([replace(joint, stiffness=tuple((w, 1.0) for w in ways))])
        every = problem.body_scalars
        pull = unit.pull(np.array([one.value for one in every]))
        return Change(
            scalars={
                problem.unknowns.index(one): -float(more)
                for one, more in zip(every, pull, strict=True)
                if one.held is None
            }
        )

    @property
    def _motions(self) -> list[PointMotion]:
        """Scalars of the motions of all coupled faces."""
        return [one for one in self.problem.body_scalars if isinstance(one, PointMotion)]

    @property
    def _shortenings(self) -> list[Shortening]:
        """One for each preload of the scene, in its order."""
        return [one for one in self.problem.body_scalars if isinstance(one, Shortening)]

    def _of_temperature(self, key: str, number: int, rest: list[str]) -> Change:
        """The change by a temperature that is the same everywhere."""
        if rest != ["value"]:
            raise _refused(key, "of temperatures, one that is the same everywhere has")
        return self._of_strains(
            key, "value", [one for one in self._thermal_strains if one.table == number]
        )

    def _of_heat(self, key: str, number: int, rest: list[str]) -> Change:
        """The change by a temperature or a flux of a boundary that is one number."""
        scene, conduction = self.problem.scene, self.problem.conduction
        assert conduction is not None
        heat, bodies, at = scene.heat[number], conduction.bodies, conduction.time
        if rest == ["temperature"]:
            place = sum(one.temperature is not None for one in scene.heat[:number])
            nodes, share = bodies.nodes_of_given(place), bodies.given[place].path(at)
            return Change(heat=lambda gradient: share * float(gradient.by_rise[nodes].sum()))
        if rest == ["flux"] and heat.flux:
            place = next(n for n, one in enumerate(bodies.flows) if one.table == number)
            flow = bodies.flows[place]
            unit = flow.path(at) / float(heat.flux) * flow.nodal  # type: ignore[arg-type]
            return Change(heat=lambda gradient: float(gradient.by_heat @ unit))
        raise _refused(key, "of heat, temperatures and fluxes have that are one number, not 0")

    def _of_conductance(self, key: str, number: int, rest: list[str]) -> Change:
        """The change by a conductance, or by one of the values of its table."""
        contact, conduction = self.problem.contacts[number], self.problem.conduction
        assert conduction is not None
        place = next(n for n, one in enumerate(conduction.contacts) if one.contact is contact)
        given = contact.contact.conductance
        if isinstance(given, Conductance) and rest[:1] == ["values"]:
            shares = partial(given.shares_at, int(rest[1]))
        elif rest:
            raise _refused(key, "of a conductance, the values have")
        else:
            assert isinstance(given, float | int)
            one, size = conduction.contacts[place], float(given)
            if size == 0:
                raise _refused(key, "where nothing is conducted, it has none")
            shares = partial(_share_of, one.conductances, size)
        return Change(heat=lambda gradient: gradient.along_conductance(place, shares))

    def _of_strains(self, key: str, name: str, strains: Sequence[ThermalStrain]) -> Change:
        """The change by a number on which thermal strains depend."""
        if self.problem.elastic.follows_temperature and name != "thermal_expansion":
            raise _refused(key, "moduli follow the temperature")
        every: list[BodyScalar] = self.problem.body_scalars
        held = {every.index(strain): strain.slope(name, self.time) for strain in strains}
        known = {place: slope for place, slope in held.items() if slope is not None}
        if len(known) < len(held):
            raise _refused(key, "temperatures and expansions have that are one number")
        return Change(held=known)

    @property
    def _thermal_strains(self) -> list[ThermalStrain]:
        """Scalars of all thermal strains."""
        return [one for one in self.problem.body_scalars if isinstance(one, ThermalStrain)]

    def _of_material(self, key: str, number: int, rest: list[str]) -> Change:
        if rest == ["density"]:
            return self._of_density(number)
        if rest and rest[0] in ("thermal_expansion", "reference_temperature"):
            strains = [one for one in self._thermal_strains if one.material == number]
            return self._of_strains(key, ".".join(rest), strains)
        if len(rest) != 1 or rest[0] not in _MODULI:
            raise _refused(
                key, "of materials, Young's modulus, Poisson's ratio and density as numbers have"
            )
        problem = self.problem
        if not isinstance(problem.elastic.law, Isotropic) or problem.elastic.has_free_strains:
            raise _refused(
                key,
                "moduli have where all materials are isotropic, without preloads and temperatures",
            )
        if problem.far_field is None:
            return Change(modulus=(number, rest[0]))
        slopes, known = problem.far_field.slopes(rest[0]), np.zeros(len(problem.far_field.dofs))
        columns: dict[int, Array] = {}
        for place, contact in enumerate(problem.contacts):
            found = [column for _, column in slopes.sideways[place]]
            if contact.force is None:
                found.insert(0, slopes.columns[place])
            else:
                known += contact.force * slopes.columns[place]
            own = [
                index
                for index, unknown in enumerate(problem.unknowns)
                if isinstance(unknown, Resultant) and unknown.contact is contact
            ]
            columns |= dict(zip(own, found, strict=True))
        prescribed = self._at_constrained(problem.far_field.dofs, known)
        return Change(prescribed=prescribed, columns=columns, modulus=(number, rest[0]))

    def _of_density(self, number: int) -> Change:
        """Return the change of the loads that follow from masses."""
        problem = self.problem
        found = np.zeros_like(problem.load)
        for load in problem.loads:
            slope = load.acting.nodal_by_density(number, problem.load_site)
            found += 0.0 if slope is None else load.path(self.time) * slope
        return Change(load=found)

    def _of_contact(self, key: str, number: int, rest: list[str]) -> Change:
        contact = self.problem.contacts[number]
        scene, name = contact.contact, ".".join(rest)
        if rest[0] == "obstacle":
            return self._of_obstacle(key, number, rest[1:])
        if rest[0] == "conductance":
            return self._of_conductance(key, number, rest[1:])
        if name == "interference":
            path = contact.paths.interference_factor(self.time)
            here = GivenChange(gap=np.full(len(contact.trace.weights), -path), interference=path)
            return Change(contacts={number: here})
        if rest[0] == "pressure" and scene.pressure is not None:
            return self._of_pressure(
                number, contact, self._at_points(contact, key, scene.pressure, rest[1:])
            )
        of_friction = rest[0].startswith("friction") or name == "regularisation_parameter"
        if of_friction and not contact.friction.has_friction:
            raise _refused(key, "without friction, it is no parameter of the model")
        name, value, inside = value_under(scene, rest)
        unit = _unit(key, value, inside)
        across = contact.normal.field_slopes(name, unit)
        along = contact.friction.field_slopes(name, unit)
        if not across and not along:
            raise _refused(key, "the laws of the contact say no derivative by it")
        return Change(contacts={number: GivenChange(across=across, along=along)})

    def _at_points(self, contact: ContactSurface, key: str, value: Value, rest: list[str]) -> Array:
        """Return the derivative of a value at the points of a contact by a number."""
        return contact.spaces.evaluate_at(_unit(key, value, rest), contact.trace.coordinates.T, key)

    def _of_pressure(self, number: int, contact: ContactSurface, unit: Array) -> Change:
        """A pressure that is given loads the body, and bounds friction."""
        trace, pressure = contact.trace, contact.paths.pressure_factor(self.time) * unit
        traction = -(trace.weights * pressure)[:, None] * trace.normals
        load = trace.surface.on_body(trace.onto_nodes(traction))
        return Change(load=load, contacts={number: GivenChange(pressure=pressure)})

    def _of_obstacle(self, key: str, number: int, rest: list[str]) -> Change:
        problem, contact = self.problem, self.problem.contacts[number]
        kinematics, obstacle = contact.kinematics, contact.contact.obstacle
        assert isinstance(kinematics, ObstacleKinematics) and obstacle is not None
        name, axis = rest[0], int(rest[1]) if len(rest) > 1 and rest[1].isdigit() else 0
        if name == "force":
            return self._of_force(number, contact)
        if name in ("moment", "rotation"):
            return self._of_turn(key, number, rest)
        if contact.gap_follows_angle and name not in ("indentation", "gap"):
            raise _refused(key, "the gap follows the angle that a moment finds")
        if name == "indentation":
            driven = contact.paths.drive_factor(self.time)
            motion = driven * kinematics.direction
            here = GivenChange(motion=motion, indentation=driven)
            return Change(contacts={number: here})
        if name == "displacement":
            factor = contact.paths.displacement_factor(self.time)
            motion = factor * np.eye(problem.spaces.components)[axis]
            gap = factor * kinematics.gap_slopes_of_motion(axis)
            return Change(contacts={number: GivenChange(motion=motion, gap=gap)})
        if name == "gap" and obstacle.gap is not None:
            gap = self._at_points(contact, key, obstacle.gap, rest[1:])
        elif name in DIRECTIONS:
            return self._of_direction(key, number, name, axis)
        elif name in ("radius", "position") and _is_smooth(obstacle, name):
            moves_foot = name == "position" and abs(kinematics.direction[axis]) < 1 - 1e-9
            if problem.far_field is not None and moves_foot:
                raise _refused(key, "it moves the force on the half_space")
            gap = kinematics.gap_slopes(name, axis)
        else:
            raise _refused(key, "contact jumps where an edge of the obstacle moves")
        gap = np.where(kinematics.reached, gap, 0.0)
        if not contact.has_unknown_position:
            return Change(contacts={number: GivenChange(gap=gap)})
        if name == "gap" and obstacle.gap is not None:  # a function of the place does not move
            first = kinematics.first_place.T
            unit = _unit(key, obstacle.gap, rest[1:])
            at_first = float(contact.spaces.evaluate_at(unit, first, key)[0])
        else:
            at_first = kinematics.first_gap_slope(name, axis)
        raised = kinematics.brought_up_slope(at_first)
        gap = np.where(kinematics.reached, gap - raised * kinematics.facing, 0.0)
        return Change(contacts={number: GivenChange(gap=gap, brought_up=raised)})

    def _of_direction(self, key: str, number: int, name: str, axis: int) -> Change:
        """Return the change by a direction, which turns an obstacle or the way it is driven."""
        problem, contact = self.problem, self.problem.contacts[number]
        kinematics, obstacle = contact.kinematics, contact.contact.obstacle
        assert isinstance(kinematics, ObstacleKinematics) and obstacle is not None
        if problem.far_field is not None:
            raise _refused(key, "it turns the force on the half_space")
        if problem.spaces.kinematics == "axisymmetric" or axis in contact.trace.symmetry.axes:
            raise _refused(key, "the model would have no symmetry")
        if obstacle.kind is not None and obstacle.kind.has_edge and name == "normal":
            raise _refused(key, "contact jumps where an edge of the obstacle moves")
        if not kinematics.keeps_right_angle(name, axis):
            raise _refused(key, "the lines of the obstacle are at a right angle to its normal")
        turned = kinematics.direction_slopes(name, axis)
        gap = np.where(kinematics.reached, kinematics.gap_slopes(name, axis), 0.0)
        motion = kinematics.indentation * turned
        if not contact.has_unknown_position:
            return Change(contacts={number: GivenChange(gap=gap, motion=motion, direction=turned)})
        faced = -contact.trace.normals @ turned
        at_first = kinematics.first_gap_slope(name, axis)
        at_first += kinematics.brought_up * float(kinematics.first_normal[0] @ turned)
        raised = kinematics.brought_up_slope(at_first)
        gap = gap - raised * kinematics.facing - kinematics.brought_up * faced
        given = GivenChange(
            gap=np.where(kinematics.reached, gap, 0.0),
            motion=motion,
            brought_up=raised,
            direction=turned,
        )
        state = contact.state()
        traction = state.friction_traction - state.contact_pressure[:, None] * contact.trace.normals
        pushed = float(contact.trace.integral(traction) @ turned)
        return Change(contacts={number: given}, scalars=self._of_indentation(contact, -pushed))

    def _of_turn(self, key: str, number: int, rest: list[str]) -> Change:
        """Return the change by the angle of an obstacle, or by the moment that turns it."""
        contact = self.problem.contacts[number]
        factor, kinematics = contact.paths.rotation_factor(self.time), contact.kinematics
        assert isinstance(kinematics, ObstacleKinematics)
        if rest == ["moment"]:
            return Change(
                scalars={
                    index: factor / kinematics.lever
                    for index, unknown in enumerate(self.problem.unknowns)
                    if unknown.turns and unknown.contact is contact
                }
            )
        if rest != ["rotation", "angle"]:
            raise _refused(key, "of an obstacle's rotation, the angle has")
        gap = factor * kinematics.gap_slopes_of_motion(-1)
        given = GivenChange(
            motion=factor * kinematics.field(np.append(np.zeros_like(kinematics.direction), 1.0)),
            gap=np.where(kinematics.reached, gap, 0.0),
            angle=factor,
        )
        return Change(contacts={number: given})

    def _of_indentation(self, contact: ContactSurface, force: float) -> dict[int, float]:
        """The right-hand side of the equation of a contact's indentation."""
        return {
            index: force
            for index, unknown in enumerate(self.problem.unknowns)
            if unknown.drives and unknown.contact is contact
        }

    def _of_force(self, number: int, contact: ContactSurface) -> Change:
        problem, path = self.problem, contact.paths.drive_factor(self.time)
        scalars = self._of_indentation(contact, path)
        far_field, prescribed = problem.far_field, None
        if far_field is not None:
            moved = path * far_field.columns[number]
            prescribed = self._at_constrained(far_field.dofs, moved)
        return Change(prescribed=prescribed, scalars=scalars)


def _is_smooth(obstacle: Obstacle, name: str) -> bool:
    """Whether gaps follow its size or place without jumps: not at the edges of punches."""
    shape = obstacle.kind
    if obstacle.file is not None:
        return name == "position"
    return shape is not None and not (shape.has_edge and name == "radius")


def _share_of(conductances: Callable[[Array], Array], size: float, pressure: Array) -> Array:
    """Conductances at pressures over the number that they are given by."""
    return conductances(pressure) / size


def _unit(key: str, value: Value, rest: list[str]) -> Value:
    """Derivative of a value in one of its numbers.

    Raises:
        InputError: It has none.
    """
    unit = slope_of(value, rest)
    if unit is None:
        raise _refused(key, _OF_PROFILES)
    return unit


def _refused(key: str, why: str) -> InputError:
    return InputError(f"by: '{key}' has no derivative: {why}")
