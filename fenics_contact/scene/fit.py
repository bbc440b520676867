"""Conditions that the parts of a scene must fulfil together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from fenics_contact.analyses import registry
from fenics_contact.scene.body import MeshSource
from fenics_contact.scene.contact import Contact, kinds_in_motion
from fenics_contact.scene.core_scene import CoreScene
from fenics_contact.scene.laws.exact import require_exact
from fenics_contact.scene.laws.finite_strains import require_finite_strains
from fenics_contact.scene.loading.conditions import Preload
from fenics_contact.scene.loading.load_paths import moduli_change, require_cycles
from fenics_contact.scene.loading.motion import Motion
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.settings import Steps
from fenics_contact.scene.values import RAMP, profiles_of

_SAME_TIME = 1e-9


def require_fit(scene: CoreScene) -> None:
    """Refuse a scene whose parts do not fit each other.

    Args:
        scene: The scene, with numbers in place of texts with units.

    Raises:
        ValueError: They do not, in a sentence that begins with the key.
    """
    _require_vectors(scene)
    _require_model(scene)
    for number, preload in enumerate(scene.preload):
        _require_bolt(scene, preload, f"preload[{number}]")
    if len(scene.mesh) > 1:
        _require_names(scene.mesh)
    _require_distinct("points", [point.name for point in scene.point])
    _require_distinct("contacts", [contact.label for contact in scene.contact])
    _require_distinct("preloads", [preload.label for preload in scene.preload])
    _require_couplings(scene)
    _require_heat(scene)
    _require_moduli(scene)
    _require_known(scene)
    require_cycles(scene)
    _require_motion(scene)
    _require_sector(scene)
    require_finite_strains(scene)
    require_exact(scene)
    for part in registry.parts_of_scene(scene, "table"):
        part.require(scene)


def _require_vectors(scene: CoreScene) -> None:
    """Refuse vectors and profiles that do not have the axes of the model."""
    dimension = scene.dimension
    for number, support in enumerate(scene.support):
        names = support.components(dimension)
        known = f"a {scene.kinematics} model has only the axes {', '.join(names)}"
        if support.axes is not None:
            support.axes.require_model(scene.kinematics, f"support[{number}].axes")
            known = f"its axes have only the components {', '.join(names)}"
        for key, given in (
            ("displacement", support.displacement),
            (support.springs[0], support.sprung(dimension)),
        ):
            for name in given:
                if name not in names:
                    raise ValueError(f"support[{number}].{key}.{name}: {known}")
        if support.rotation is not None:
            support.rotation.require_model(scene.kinematics, f"support[{number}].rotation")
    vectors: dict[str, Sequence[object]] = {
        f"support[{number}].rotation.at": support.rotation.at
        for number, support in enumerate(scene.support)
        if support.rotation is not None and support.rotation.at is not None
    }
    vectors |= {
        f"support[{number}].moment_about": support.moment_about
        for number, support in enumerate(scene.support)
        if support.moment_about is not None
    }
    for number, load in enumerate(scene.load):
        vectors |= load.vectors(f"load[{number}]")
    vectors |= {
        f"point[{number}].at": point.at
        for number, point in enumerate(scene.point)
        if point.at is not None
    }
    for key, vector in vectors.items():
        if len(vector) != dimension:
            raise ValueError(
                f"{key} has {len(vector)} entries; a {scene.kinematics} model needs {dimension}"
            )
    if dimension == 2 and any(profile.along == "z" for profile in profiles_of(scene)):
        raise ValueError(f"a profile along z: a {scene.kinematics} model has only x and y")
    for number, contact in enumerate(scene.contact):
        key = f"contact[{number}]"
        _require_axes(contact.obstacle, dimension, f"{key}.obstacle")
        _require_axes(contact, dimension, key)
        if scene.kinematics == "axisymmetric" and contact.moment_about is not None:
            raise ValueError(f"{key}.moment_about: of a whole turn there are no moments")
        if dimension == 2 and contact.axis is not None:
            raise ValueError(
                f"{key}.axis: a {scene.kinematics} model has no torque about an axis in its plane; "
                "in the plane give moment_about alone"
            )


def _require_model(scene: CoreScene) -> None:
    """Refuse keys that the kinematic model does not have."""
    if scene.thickness is not None and scene.kinematics != "plane stress":
        raise ValueError(f"thickness is for plane stress, not for {scene.kinematics}")
    if isinstance(scene.thickness, float | int) and scene.thickness <= 0:
        raise ValueError(f"thickness = {scene.thickness:g} must be greater than 0")
    for number, contact in enumerate(scene.contact):
        if contact.friction_law is not None:
            contact.friction_law.require_model(scene.kinematics, f"contact[{number}]")
        _require_turn(scene, contact, f"contact[{number}].obstacle.rotation")
    _require_centres(scene)
    for number, load in enumerate(scene.load):
        load.require_model(scene.kinematics, f"load[{number}]")
    besides = [key for key in ("load", "preload", "temperature") if getattr(scene, key)]
    if scene.half_space is not None and besides:
        what = besides[0]
        raise ValueError(f"half_space: only the contacts' forces reach it, so leave out {what}")
    springs = _springs(scene)
    if scene.half_space is not None and springs:
        raise ValueError(f"half_space: its boundary holds it, so leave out {springs[0]}")
    if scene.half_space is not None and scene.kinematics == "plane stress":
        raise ValueError("half_space is for plane strain, axisymmetric and 3D models")


def _require_turn(scene: CoreScene, contact: Contact, key: str) -> None:
    """Refuse an obstacle that turns where the model has no such motion."""
    turning = None if contact.obstacle is None else contact.obstacle.turning
    if turning is None:
        return
    turning.require_model(scene.kinematics, key)
    if turning.at is not None and len(turning.at) != scene.dimension:
        raise ValueError(
            f"{key}.at has {len(turning.at)} entries; a {scene.kinematics} model needs "
            f"{scene.dimension}"
        )
    if scene.half_space is not None:
        raise ValueError(
            f"{key}: on a half_space no obstacle turns yet, as its far field is that of forces, "
            "not of moments; leave one of the two out"
        )


def _require_heat(scene: CoreScene) -> None:
    """Refuse what has no meaning, or cannot be had yet, where heat flows.

    Raises:
        ValueError: In words.
    """
    if not scene.heat:
        for number, contact in enumerate(scene.contact):
            if contact.conductance is not None:
                raise ValueError(f"contact[{number}].conductance: nothing flows; give [[heat]]")
        return
    others = {
        "temperature": bool(scene.temperature),
        "half_space": scene.half_space is not None,
        **dict.fromkeys(registry.tables_not_with(scene, "heat"), True),
    }
    for key, is_there in others.items():
        if is_there:
            raise ValueError(f"heat: not beside {key} yet; leave one of the two out")
    if scene.solver.solver not in ("auto", "condensed"):
        raise ValueError(
            f"heat: it is found by 'condensed', not by solver.solver = '{scene.solver.solver}'"
        )
    if len({material.reference_temperature for material in scene.material}) > 1:
        raise ValueError("heat: all materials need one reference_temperature")
    for number, material in enumerate(scene.material):
        if material.conductivity is None:
            key = f"material[{number}]" if len(scene.material) > 1 else "material"
            raise ValueError(f"{key}.conductivity is missing: heat flows")
    for number, contact in enumerate(scene.contact):
        if contact.conductance is not None and contact.against is None:
            raise ValueError(
                f"contact[{number}].conductance: heat crosses between two bodies; give against"
            )


def _require_moduli(scene: CoreScene) -> None:
    """Refuse what cannot be had yet where moduli follow the temperature.

    Raises:
        ValueError: In words.
    """
    number = next((n for n, one in enumerate(scene.material) if one.follows_temperature), None)
    if number is None:
        return
    key = f"material[{number}]" if len(scene.material) > 1 else "material"
    if any(material.stiffness is not None for material in scene.material):
        raise ValueError(
            f"{key}: moduli follow the temperature, which takes isotropic materials: leave "
            "stiffness out"
        )
    if not moduli_change(scene):
        return
    others = {
        "coupling": bool(scene.coupling),
        "contacts that are solved exactly": scene.is_exact,
        f"solver.solver = '{scene.solver.solver}'": scene.solver.solver in ("full", "iterative"),
        **dict.fromkeys(registry.tables_not_with(scene, "heat"), True),
    }
    for other, is_there in others.items():
        if is_there:
            raise ValueError(
                f"{key}: moduli follow the temperature, which changes in the run: not beside "
                f"{other} yet; leave one of the two out, or give one load step and temperatures"
            )


def _require_couplings(scene: CoreScene) -> None:
    """Refuse couplings that a model cannot have, or that share names."""
    for number, coupling in enumerate(scene.coupling):
        key = f"coupling[{number}]"
        for name in ("at", "force"):
            given = getattr(coupling, name)
            if given is not None and len(given) != scene.dimension:
                raise ValueError(
                    f"{key}.{name} has {len(given)} entries; a {scene.kinematics} model needs "
                    f"{scene.dimension}"
                )
        coupling.require_model(scene.kinematics, key)
    labels = [coupling.label for coupling in scene.coupling]
    for number, spring in enumerate(scene.spring):
        spring.require_model(scene.kinematics, labels, f"spring[{number}]")
    names = [support.label for support in scene.support]
    _require_distinct("couplings", [one.label for one in scene.coupling])
    if same := {one.label for one in scene.coupling} & set(names):
        raise ValueError(
            f"coupling: '{min(same)}' is the name of a support, too; give the coupling another name"
        )
    if scene.coupling and scene.half_space is not None:
        raise ValueError("half_space: only the contacts' forces reach it, so leave out coupling")


def _require_centres(scene: CoreScene) -> None:
    """Refuse points of moments of reactions that have none, or whose moments do not add up."""
    centres: dict[str, tuple[float, ...]] = {}
    for number, support in enumerate(scene.support):
        key, about = f"support[{number}].moment_about", support.moment_about
        if about is None:
            continue
        if scene.kinematics == "axisymmetric":
            raise ValueError(f"{key}: of a whole turn there are no moments")
        other = centres.setdefault(support.label, about)
        if other != about:
            raise ValueError(
                f"{key} = {list(about)}: another support called '{support.label}' has "
                f"{list(other)}, but the moments of supports of the same name add up; give both "
                "the same point, or one of them another name"
            )


def _springs(scene: CoreScene) -> list[str]:
    """Keys of the stiffness of supports that are springs."""
    return [
        f"support[{number}].{support.key_of_springs}"
        for number, support in enumerate(scene.support)
        if support.is_elastic
    ]


def _require_bolt(scene: CoreScene, preload: Preload, key: str) -> None:
    """Refuse a bolt whose axis does not fit the model, or is locked where no load step ends."""
    axis, locked, motion = preload.axis, preload.locked_from, scene.motion
    steps = scene.steps if motion is None else motion.steps
    if len(axis) != scene.dimension:
        raise ValueError(
            f"{key}.axis has {len(axis)} entries; a {scene.kinematics} model needs "
            f"{scene.dimension}"
        )
    if preload.between is not None and not scene.mesh:
        raise ValueError(
            f"{key}.between: only a body of a CAD file can be cut; of a mesh, preload a group of "
            "its cells"
        )
    if scene.kinematics == "axisymmetric" and axis[0] != 0:
        raise ValueError(f"{key}.axis: must be along y, the axis of revolution")
    if locked is None:
        return
    if scene.cycles is None and locked > steps.last * (1 + _SAME_TIME):
        raise ValueError(
            f"{key}.locked_from = {locked:g}: the last load step ends at {steps.last:g}"
        )
    if motion is not None and motion.start == "static":
        return  # it has been tightened when the motion begins
    ends = steps.all_times if scene.cycles is None else (*steps.all_times, scene.cycles.begin)
    if not steps.automatic and locked < ends[0] * (1 - _SAME_TIME):
        raise ValueError(
            f"{key}.locked_from = {locked:g}: lies before the end of the first load step, "
            f"{ends[0]:g}, so that no force has tightened it yet"
        )
    if not steps.automatic and min(abs(locked - end) for end in ends) > _SAME_TIME * locked:
        raise ValueError(
            f"{key}.locked_from = {locked:g}: no load step ends there; add it to steps.times"
        )


def _require_known(scene: CoreScene) -> None:
    """Every quantity that an accuracy is asked of is one of the scene."""
    for name in () if scene.accuracy is None else scene.accuracy.of:
        try:
            scene.names.find(name)
        except ValueError as error:
            raise ValueError(f"accuracy: {error}") from None


def _require_names(meshes: tuple[MeshSource, ...]) -> None:
    """Several meshes are told apart by their names."""
    for number, mesh in enumerate(meshes):
        if not mesh.name:
            raise ValueError(f"mesh[{number}].name is missing: each of several meshes needs one")
    _require_distinct("meshes", [mesh.name for mesh in meshes])


def _require_distinct(things: str, names: Sequence[str]) -> None:
    """Things of one kind are told apart by their names."""
    name, count = Counter(names).most_common(1)[0] if names else ("", 0)
    if count > 1:
        raise ValueError(f"two {things} are called '{name}': give each its own name")


def _require_axes(table: Obstacle | Contact | None, dimension: int, key: str) -> None:
    """Vectors of an obstacle or a contact have one entry an axis."""
    names = ("position", "normal", "along", "direction", "displacement", "axis", "moment_about")
    for name in names:
        vector = getattr(table, name, None)
        if vector is not None and len(vector) != dimension:
            raise ValueError(f"{key}.{name} has {len(vector)} entries; it needs {dimension}")


def _require_motion(scene: CoreScene) -> None:
    """Refuse what has no meaning, or cannot be had yet, where bodies move, and laws that need it.

    Raises:
        ValueError: In words.
    """
    motion = scene.motion
    if motion is None:
        for number, contact in enumerate(scene.contact):
            law = contact.friction_law
            if law is not None and law.needs_motion:
                raise ValueError(
                    f"contact[{number}].friction_law: {law.kind} friction follows velocities, and "
                    "nothing moves here: give [motion]"
                )
        return
    others = {
        "steps": scene.steps != Steps(),
        "cycles": scene.cycles is not None,
        "half_space": scene.half_space is not None,
        "accuracy": scene.accuracy is not None,
        **dict.fromkeys(registry.tables_not_with(scene, "motion"), True),
        "solver.branches": scene.solver.branches,
        "solver.stabilisation": scene.solver.stabilisation,
        "temperature": bool(scene.temperature),
        "heat": bool(scene.heat),
        **dict.fromkeys(_springs(scene), True),
    }
    for key, is_there in others.items():
        if is_there:
            raise ValueError(f"motion: bodies that move have no {key}; leave one of the two out")
    if scene.solver.solver not in ("auto", "condensed"):
        raise ValueError(
            f"motion: it is solved by 'condensed', not by solver.solver = '{scene.solver.solver}'"
        )
    for group, velocity in motion.velocity.items():
        if len(velocity) != scene.dimension:
            raise ValueError(
                f"motion.velocity.{group} has {len(velocity)} entries; a {scene.kinematics} model "
                f"needs {scene.dimension}"
            )
    if scene.preload and motion.rayleigh is not None and motion.rayleigh.stiffness > 0:
        raise ValueError(
            "motion.rayleigh.stiffness: not beside a preload, whose shortening it would resist as "
            "if it were a strain; give motion.rayleigh.mass"
        )
    for number, coupling in enumerate(scene.coupling):
        if not coupling.is_rigid and any(coupling.given.values()):
            raise ValueError(
                f"motion: coupling[{number}].kind = 'distributing': where bodies move, what is "
                "given of its point is 0 or left out; kind = 'rigid' moves a boundary"
            )
    _require_own_paths(scene)
    _require_free_modes(scene, motion)
    for number, contact in enumerate(scene.contact):
        _require_contact_moves(contact, f"contact[{number}]")


def _require_free_modes(scene: CoreScene, motion: Motion) -> None:
    """Modes are those of bodies alone: nothing damps, rubs or ties them."""
    if motion.modes is None:
        return
    others = {
        "motion.rayleigh": motion.rayleigh is not None,
        "motion.absorbing": bool(motion.absorbing),
        "preload": bool(scene.preload),
        "coupling": bool(scene.coupling),
    }
    for number, contact in enumerate(scene.contact):
        others[f"contact[{number}] with friction"] = contact.is_rough
        others[f"contact[{number}].kind = 'bonded'"] = contact.kind == "bonded"
    for key, is_there in others.items():
        if is_there:
            raise ValueError(f"motion.modes: not beside {key} yet; leave one of the two out")


def _require_own_paths(scene: CoreScene) -> None:
    """Refuse loads without a path of their own: the ramp of load steps would end at time 1."""
    acting = {
        **{f"load[{number}].path": load.path for number, load in enumerate(scene.load)},
        **{
            f"support[{number}].path": support.path
            for number, support in enumerate(scene.support)
            if support.moves
        },
        **{
            f"preload[{number}].path": preload.path
            for number, preload in enumerate(scene.preload)
            if preload.locked_from is None
        },
        **{
            f"coupling[{number}].path": coupling.path
            for number, coupling in enumerate(scene.coupling)
            if any((coupling.given | coupling.acting).values())
        },
    }
    for number, contact in enumerate(scene.contact):
        obstacle = contact.obstacle
        if obstacle is not None and obstacle.indentation:
            acting[f"contact[{number}].obstacle.path"] = obstacle.path
        if obstacle is not None and obstacle.displacement is not None:
            acting[f"contact[{number}].obstacle.displacement_path"] = obstacle.displacement_path
    for key, path in acting.items():
        if path == RAMP:
            raise ValueError(
                f"motion: {key} is missing, or is the ramp of load steps from 0 to 1: say how it "
                "acts in time; what always acts has { time = [0], factor = [1] }, a ramp goes on "
                "as long as the motion"
            )


def _require_contact_moves(contact: Contact, key: str) -> None:
    if contact.obstacle is not None and contact.obstacle.force is not None:
        raise ValueError(f"motion: {key}.obstacle.force: an obstacle has no mass; move it instead")
    if contact.obstacle is not None and contact.obstacle.turning is not None:
        raise ValueError(
            f"motion: {key}.obstacle.rotation: where bodies move no obstacle turns yet; leave it "
            "out"
        )
    if contact.wear is not None:
        raise ValueError(f"motion: {key}.wear: bodies that move do not wear yet; leave it out")
    if not contact.fits_motion:
        kinds = ", ".join(kinds_in_motion())
        raise ValueError(f"motion: {key}: only contacts that are {kinds} can move yet")
    law = contact.friction_law
    follows = contact.law != "static" and (law is None or law.fits_motion)
    if contact.is_rough and not follows:
        raise ValueError(
            f"motion: {key}: only Coulomb's friction of law = 'incremental', or with a "
            "friction_law of kind = 'speed dependent', follows velocities yet"
        )


def _require_sector(scene: CoreScene) -> None:
    """Refuse what a sector of a ring cannot have, or not yet.

    Raises:
        ValueError: In words.
    """
    sector = scene.cyclic_symmetry
    if sector is None:
        return
    sector.require_model(scene.kinematics)
    others = {
        "half_space": scene.half_space is not None,
        "motion": scene.motion is not None,
        "solver.solver = 'iterative'": scene.solver.solver == "iterative",
        **dict.fromkeys(registry.tables_not_with(scene, "cyclic symmetry"), True),
        **{
            f"contact[{number}].friction_law of kind = '{law.kind}'": law.averages
            for number, contact in enumerate(scene.contact)
            if (law := contact.friction_law) is not None
        },
        **{
            f"contact[{number}].obstacle.rotation": obstacle.turning is not None
            for number, contact in enumerate(scene.contact)
            if (obstacle := contact.obstacle) is not None
        },
    }
    for key, is_there in others.items():
        if is_there:
            raise ValueError(f"cyclic_symmetry: not with {key} yet; leave one of the two out")
