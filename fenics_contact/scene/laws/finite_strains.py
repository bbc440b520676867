"""Conditions for scenes with finite strains: what they need, and what does not go with them yet."""

from __future__ import annotations

from fenics_contact.analyses import registry
from fenics_contact.analytic import obstacle_shapes
from fenics_contact.scene.body import NEARLY_INCOMPRESSIBLE, Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.core_scene import CoreScene
from fenics_contact.scene.laws import energies
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import Obstacle

# Kinds of loads whose forces do not turn with the body, nor depend on where it is.
_DEAD = ("traction", "body_force")
_ASK = 'strains = "finite"'


def require_finite_strains(scene: CoreScene) -> None:
    """Refuse what does not go with finite strains yet, and laws that only they have.

    Args:
        scene: Any; of one with small strains no material may have a stored energy.

    Raises:
        ValueError: In a sentence that begins with the key.
    """
    materials = {"material": scene.material[0]}
    if len(scene.material) > 1:
        materials = {f"material[{number}]": one for number, one in enumerate(scene.material)}
    if not scene.has_finite_strains:
        for key, material in materials.items():
            if material.law is not None:
                raise ValueError(f"{key}.law: only {_ASK} has stored energies; set it, or no law")
        return
    if scene.kinematics != "plane strain":
        raise ValueError(
            f"{_ASK}: is for kinematics = 'plane strain' yet, not for '{scene.kinematics}'"
        )
    for key, material in materials.items():
        _require_material(material, key, scene.material[0])
    _refuse(_not_yet_with(scene), _ASK)
    for number, support in enumerate(scene.support):
        _refuse(_of_support(support), f"support[{number}] with {_ASK}")
    for number, load in enumerate(scene.load):
        if load.kind not in _DEAD:
            raise ValueError(
                f"load[{number}].{load.kind}: with {_ASK} loads are a traction or a body_force "
                "yet, over undeformed areas and volumes"
            )
    for number, contact in enumerate(scene.contact):
        _require_contact(contact, f"contact[{number}]", scene.steps.several)


def _refuse(others: dict[str, bool], what: str) -> None:
    """Refuse the first of some keys that is there."""
    for key, is_there in others.items():
        if is_there:
            raise ValueError(f"{what}: not with {key} yet; leave one of the two out")


def _require_material(material: Material, key: str, first: Material) -> None:
    """Each material has the stored energy of the first, and is compressible and isotropic."""
    if material.law is None:
        *others, last = energies.names()
        raise ValueError(
            f"{key}.law is missing: {_ASK} needs the stored energy, {', '.join(others)} or {last}"
        )
    if material.law != first.law:
        raise ValueError(
            f"{key}.law = '{material.law}': all materials have one law yet, '{first.law}'"
        )
    if material.constants != first.constants:
        raise ValueError(f"{key}.constants: all materials have the same ones yet")
    if material.constants and not isinstance(material.poissons_ratio, float | int):
        raise ValueError(f"{key}.poissons_ratio: beside constants it must be a number")
    if material.stiffness is not None or material.follows_temperature:
        raise ValueError(
            f"{key}: {_ASK} takes numbers, profiles or functions for youngs_modulus and "
            "poissons_ratio, no stiffness and no table of temperature"
        )
    ratio = material.poissons_ratio
    if isinstance(ratio, float | int) and ratio >= NEARLY_INCOMPRESSIBLE:
        raise ValueError(
            f"{key}.poissons_ratio = {ratio:g}: with {_ASK} it is below {NEARLY_INCOMPRESSIBLE} "
            "yet, as nearly incompressible bodies lock"
        )


def _not_yet_with(scene: CoreScene) -> dict[str, bool]:
    """Tables and settings that do not go with finite strains yet, and whether they are there."""
    solver = scene.solver
    return {
        "half_space": scene.half_space is not None,
        "preload": bool(scene.preload),
        "coupling": bool(scene.coupling),
        "temperature": bool(scene.temperature),
        "heat": bool(scene.heat),
        "motion": scene.motion is not None,
        "cycles": scene.cycles is not None,
        "cyclic_symmetry": scene.cyclic_symmetry is not None,
        "accuracy": scene.accuracy is not None,
        **dict.fromkeys((key for one in registry.asked_by(scene) for key in one.tables), True),
        f"solver.solver = '{solver.solver}'": solver.solver not in ("auto", "condensed"),
        f"solver.strategy = '{solver.strategy}'": solver.strategy not in ("auto", "exact"),
        "solver.stabilisation": solver.stabilisation,
        "solver.branches": solver.branches,
        "solver.all_answers": solver.all_answers,
        "solver.exact_check": solver.exact_check is True,
        "solver.errors = 'all'": solver.errors == "all",
        "solver.slip_limit = 'steps'": solver.slip_limit == "steps",
    }


def _of_support(support: Support) -> dict[str, bool]:
    """Keys of a support that do not go with finite strains yet, and whether they are there."""
    return {
        "rotation": support.rotation is not None,
        "axes": support.axes is not None,
        "moment_about": support.moment_about is not None,
        "springs": support.is_elastic,
    }


def _require_contact(contact: Contact, key: str, has_steps: bool) -> None:
    """A contact is with a rigid obstacle whose place is given, and is solved exactly."""
    others = {
        "against": contact.against is not None,
        f"contact = '{contact.kind}'": contact.kind != "unilateral",
        "normal_law": contact.normal_law is not None,
        "friction_law": contact.friction_law is not None and contact.friction_law.kind != "coulomb",
        "interference": bool(contact.interference),
        "wear": contact.wear is not None,
        "moment_about": contact.moment_about is not None,
    }
    _refuse(others, f"{key} with {_ASK}")
    for name in ("penalty_parameter", "regularisation_parameter"):
        value = getattr(contact, name)
        if value not in ("auto", 0):
            raise ValueError(
                f"{key}.{name} = {value:g}: with {_ASK} contacts are solved exactly; leave it out"
            )
    if contact.is_rough and contact.law == "static" and has_steps:
        raise ValueError(
            f"{key}.law = 'static': with {_ASK} friction acts on the slip of each load step, as "
            'the total displacement says nothing of a long path; set law = "incremental"'
        )
    _require_obstacle(contact.obstacle, f"{key}.obstacle")


def _require_obstacle(obstacle: Obstacle | None, key: str) -> None:
    """An obstacle has a shape whose nearest point is known, and is driven by displacements."""
    shape = None if obstacle is None else obstacle.shape
    known = obstacle_shapes.names_with_nearest("plane strain")
    if obstacle is None or shape not in known:
        named = "it has none" if shape is None else f"it is '{shape}'"
        accepted = " or ".join(f"'{name}'" for name in known)
        raise ValueError(f"{key}.shape: with {_ASK} it is {accepted} yet; {named}")
    if obstacle.normal is None:
        raise ValueError(
            f"{key}.normal is missing: with {_ASK} say which way the obstacle faces, as the "
            "surface of the body turns"
        )
    others = {
        "force": obstacle.force is not None,
        "moment": obstacle.moment is not None,
    }
    _refuse(others, f"{key} with {_ASK}")
