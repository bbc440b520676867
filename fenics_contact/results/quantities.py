"""The quantities of a run: what each means, which have a true value, and which say something."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from fenics_contact.results.records.contacts import ContactRecord, SupportRecord
from fenics_contact.results.records.record import Quantities
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.laws.normal_laws import NormalLawTable
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.reference import measured_by as measured_by_key

# Of a quantity: a number, or the components of a vector.
QuantityValue = float | Sequence[float]


@dataclass(frozen=True)
class Quantity:
    """A key of ``quantities``.

    Attributes:
        name: The key.
        unit: Such as ``force``; empty of a pure number.
        meaning: What it is of a contact, or of the whole model where contacts have none.
        whole: What the whole model's is made of; empty where contacts have none.
        has_true_value: Whether there is one to be apart from: then it has an error bar. Others
            count points, or say how a run went.
        needs: ``friction``, or ``contact found`` and not given; without it nothing is said.
    """

    name: str
    unit: str
    meaning: str
    whole: str = ""
    has_true_value: bool = True
    needs: str = ""


_OF_THE_ONLY = "of the only contact; `null` with several"
_OF_A_DISC = "of the only contact that has one"
# In the order in which they are shown.
ALL = (
    Quantity(
        "normal_force",
        "force",
        "resultant of the contact pressure along the axis of the contact, > 0 when it pushes. The "
        "axis is that along which an obstacle is driven, by default its normal. Where there is no "
        "obstacle, or one that has neither a shape nor a direction, the axis is the mean normal of "
        "the whole surface `on`, touching or not; between bodies it is the mean normal of `on` "
        "less that of `against`. Components across planes of symmetry that the surface ends in, "
        "and the radius of an axisymmetric model, are left out of it. `null` where that mean "
        "normal is shorter than .5: the surface wraps around, and no one direction stands for it",
        _OF_THE_ONLY,
    ),
    Quantity(
        "pressure_integral",
        "force",
        "∫ p dA, also where `normal_force` is `null`. On a flat surface the two are equal; on a "
        "curved one the integral is larger",
        _OF_THE_ONLY,
    ),
    Quantity(
        "friction_force",
        "force",
        "resultant of the friction traction, a vector. On a curved surface it has a part along the "
        "axis",
        _OF_THE_ONLY,
        needs="friction",
    ),
    Quantity(
        "contact_force",
        "force",
        "resultant of pressure and friction together, a vector: what loads, other contacts and "
        "supports balance",
        _OF_THE_ONLY,
    ),
    Quantity(
        "reaction",
        "force",
        "resultant of all supports on the bodies, a vector; each support's own is under `supports`",
    ),
    Quantity(
        "indentation",
        "length",
        "how far a rigid obstacle has been driven, where there is one",
        "of the only one",
        needs="contact found",
    ),
    Quantity(
        "max_contact_pressure",
        "stress",
        "the largest pressure at a contact point; on quadratic triangles that of the function on "
        "the facets which is nearest to the pressures at the points and has the same forces",
        "the largest of all",
    ),
    Quantity(
        "max_penetration",
        "length",
        "the deepest overlap that the penalty leaves, or the depth in a foundation",
        "the largest of all",
        needs="contact found",
    ),
    Quantity(
        "contact_area", "area", "area in contact; its edge is found inside the elements", "sum"
    ),
    Quantity("stick_area", "area", "the part of it that sticks", "sum", needs="friction"),
    Quantity(
        "slip_area",
        "area",
        "the part of it that slips. Without friction all of it slips",
        "sum",
        needs="friction",
    ),
    Quantity(
        "contact_radius",
        "length",
        "in axisymmetric models, of a surface that reaches the axis: radius of the disc that "
        "touches around the axis. 0 where nothing touches; `null` where something touches, but not "
        "at the axis",
        _OF_A_DISC,
    ),
    Quantity(
        "stick_radius", "length", "likewise, of the disc that sticks", _OF_A_DISC, needs="friction"
    ),
    Quantity(
        "max_slip",
        "length",
        "the largest slip since the start **of points that touch** at the end; 0 where none "
        "touches. Open points have no slip to speak of, whatever `contact.csv` says of their "
        "motion",
        "the largest of all",
        needs="friction",
    ),
    Quantity("strain_energy", "energy", "½ a(u, u)"),
    Quantity(
        "external_work",
        "energy",
        "work of loads, supports, obstacles, preloads and interferences along the load steps; of a "
        "single step that of the final forces on the final displacements, which is twice the "
        "strain energy where all grows in proportion. An interference does work on its way beyond "
        "a gap that is drawn",
    ),
    Quantity(
        "friction_work",
        "energy",
        "dissipated by friction since the start, ≥ 0; where friction has micro-slip, less what "
        "rising pressures add to `elastic_slip_energy`, which can make it negative",
        "sum",
        needs="friction",
    ),
    Quantity(
        "worn_volume",
        "volume",
        "what both surfaces together have lost by wear since the start",
        "sum",
    ),
    Quantity(
        "max_wear_depth",
        "length",
        "the deepest wear at a contact point, of both surfaces together",
        "the largest of all",
    ),
    Quantity(
        "worn_volume_on",
        "volume",
        "the part of `worn_volume` that the surface `on` has lost, where `wear.share` says it",
        "sum of those that have it",
    ),
    Quantity(
        "worn_volume_against",
        "volume",
        "likewise of the surface `against`",
        "sum of those that have it",
    ),
    Quantity(
        "max_wear_depth_on",
        "length",
        "the part of `max_wear_depth` that the surface `on` has lost, likewise",
        "the largest of those that have it",
    ),
    Quantity(
        "max_wear_depth_against",
        "length",
        "likewise of the surface `against`",
        "the largest of those that have it",
    ),
    Quantity("penalty_energy", "energy", "in the springs of penalty, foundation or glue", "sum"),
    Quantity(
        "elastic_slip_energy",
        "energy",
        "stored along surfaces whose friction has micro-slip, in the slip that goes back",
        "sum over those that have it",
        needs="friction",
    ),
    Quantity(
        "kinetic_energy",
        "energy",
        "½ v · M v, where bodies move (`[motion]`)",
    ),
    Quantity(
        "left_out_kinetic_energy",
        "energy",
        "of what gives way beside the modes of `motion.modes`, which take it for none",
    ),
    Quantity(
        "damping_work",
        "energy",
        "what `motion.rayleigh` and `motion.absorbing` took since the start",
    ),
    Quantity(
        "momentum",
        "impulse",
        "of all that moves, a vector; of a revolution its part along the axis",
    ),
    Quantity(
        "impulse",
        "impulse",
        "∫ `contact_force` dt since the start, a vector, where bodies move",
        _OF_THE_ONLY.replace("; `null` with several", "; not there with several"),
    ),
    Quantity(
        "energy_defect",
        "energy",
        "what the load steps leave open of the balance of work and energies; not of a single step",
        has_true_value=False,
    ),
    Quantity("displacement_NAME", "length", "at each `[[point]]`, a vector"),
    Quantity(
        "obstacle_displacement",
        "length",
        "how far an obstacle has been moved besides, a vector, where the scene moves it",
        "not there",
        has_true_value=False,
    ),
    Quantity(
        "slip_share",
        "",
        "with friction: how much of what it can hold against rigid slip of one side along the "
        "other it does hold, 0 … 1: the largest ∫ τ · r dA / ∫ g |r| dA of rigid motions r along "
        "all that touches, with the traction τ and its bound g; of a torque, too. `null` where "
        "no rigid motion slips along all that touches, as of a key, or of a cone that has no "
        "rotation",
        "not there",
        has_true_value=False,
    ),
    Quantity(
        "undecided_points",
        "",
        "with friction: how many points slip by less than 2ε",
        "not there",
        has_true_value=False,
    ),
    Quantity(
        "slip_since_pairing",
        "",
        "between bodies: largest slip of points that touch since it was found what faces what, "
        "over the size of the contact",
        "not there",
        has_true_value=False,
    ),
    Quantity(
        "closed_gap",
        "length",
        "between bodies: the widest gap of the meshes that has closed",
        "not there",
        has_true_value=False,
    ),
)
_OF_POINTS = "displacement_"
# Those that have a true value and the same name in every run.
QUANTITIES = tuple(
    one.name for one in ALL if one.has_true_value and not one.name.startswith(_OF_POINTS)
)


#: What quantities of preloads measure.
MEASURED_BY_PRELOADS = {"force": "force", "elongation": "length"}


def has_true_value(name: str) -> bool:
    """Whether a quantity has a true value to be apart from: then an error bar, or a ``?``."""
    return name in QUANTITIES or name.startswith(_OF_POINTS)


def measured_by(name: str) -> str:
    """What a quantity measures, such as ``stress``; empty of a pure number, or one not known."""
    if name.startswith(_OF_POINTS):
        return "length"
    return next((one.unit for one in ALL if one.name == name), "")


def measured_by_parameter(name: str) -> str:
    """What a parameter of a contact measures, as the scene's key of its name does."""
    return measured_by_key(name, Contact, Obstacle, *NormalLawTable.__subclasses__())


def idle_quantities(contacts: Sequence[ContactRecord]) -> set[str]:
    """Names of the quantities that say nothing about some contacts, and are not shown."""
    missing = set()
    if all(not contact.carries_shear for contact in contacts):
        missing.add("friction")
    if all(contact.pressure_is_given for contact in contacts):
        missing.add("contact found")
    return {one.name for one in ALL if one.needs in missing}


def without_value(name: str, quantities: Quantities) -> str:
    """Why a quantity of a contact has no value, in words.

    Args:
        name: Of the quantity.
        quantities: All of the contact, or of the whole model with this contact alone.
    """
    if quantities.get("pressure_integral") is None:
        return "not known"  # an earlier version of the program has not written it
    return {
        "normal_force": "none, the surface wraps around",
        "contact_radius": "none, no contact at the axis",
        "stick_radius": "none, no stick at the axis",
        "slip_share": "-",
    }.get(name, "none")


def reactions_by_name(supports: Sequence[SupportRecord]) -> dict[str, list[float]]:
    """Resultant of the supports of each name."""
    found: dict[str, list[float]] = {}
    for support in supports:
        before = found.get(support.label, [0.0] * len(support.reaction))
        found[support.label] = [a + b for a, b in zip(before, support.reaction, strict=True)]
    return found
