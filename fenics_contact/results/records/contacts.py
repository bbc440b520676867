"""Contacts, supports and preloads, of a run, of a load step or of one of several answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from fenics_contact.quantities.table import OF_SUPPORTS
from fenics_contact.results.contact_points import PointArray
from fenics_contact.results.records.record import Errors, Quantities, Record


@dataclass(frozen=True, eq=False, kw_only=True)
class LawAnswers(Record):
    """What the laws of a contact answer, for pages and pictures.

    Attributes:
        pressure_is_given: Whether the pressure is the scene's, and nothing of it is found.
        is_rigid: Whether what stands opposite is not to be entered.
        carries_shear: Whether forces along the surface act: friction, or glue.
    """

    pressure_is_given: bool
    is_rigid: bool
    carries_shear: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class ArrayRecord(Record):
    """What a law keeps of its own at the contact points, as columns of `contact.csv` and a field.

    Attributes:
        name: Of the field.
        unit: Such as `length`.
        is_vector: Whether it has a component along each axis.
        column: Its name in `contact.csv`; of a vector, what stands before `_x`, `_y` and `_z`.
    """

    name: str
    unit: str
    is_vector: bool
    column: str


def array_record(array: PointArray) -> ArrayRecord:
    """An array at contact points as ``result.json`` has it."""
    column = array.column or array.name
    return ArrayRecord(name=array.name, unit=array.unit, is_vector=array.is_vector, column=column)


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactRecord(Record):
    """A contact, in the order of the scene.

    Attributes:
        name: That of the scene.
        contact: `prescribed`, `unilateral`, `winkler`, `bonded`, or the name of a further law.
        law: Of friction: `none`, `static`, `incremental`, `stick`, or the name of a further law.
        answers: What its laws answer.
        slave: Between bodies: the surface whose points carry the contact.
        master: Between bodies: the surface opposite.
        slave_reason: Between bodies: why it is this one.
        parameters: Those of its laws as used, also when chosen automatically; `varies` of one that
            varies in space.
        arrays: What its laws keep of their own at the points.
        uniqueness_limit: Estimate of the friction coefficient up to which the answer is the only
            one.
        quantities: Of this contact alone; empty without an answer.
        errors: Estimated errors of these.
        bias: Of these, as that of the whole model.
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset(
        {"arrays", "slave", "master", "slave_reason", "uniqueness_limit", "errors", "bias"}
    )

    name: str
    contact: str
    law: str
    answers: LawAnswers
    slave: str | None = None
    master: str | None = None
    slave_reason: str | None = None
    parameters: Mapping[str, Any]
    arrays: list[ArrayRecord] = field(default_factory=list)
    uniqueness_limit: float | None = None
    quantities: Quantities
    errors: Errors = field(default_factory=dict)
    bias: Mapping[str, Any] = field(default_factory=dict)

    @property
    def own_arrays(self) -> tuple[PointArray, ...]:
        """State variables of its laws at the points, which files and pictures have."""
        return tuple(PointArray(**array) for array in self.arrays)

    @property
    def pressure_is_given(self) -> bool:
        """Whether the pressure is the scene's, and nothing of it is found."""
        return self.answers.pressure_is_given

    @property
    def is_rigid(self) -> bool:
        """Whether what stands opposite is not to be entered, so that it is drawn as a solid."""
        return self.answers.is_rigid

    @property
    def carries_shear(self) -> bool:
        """Whether forces along the surface act: friction, or glue."""
        return self.answers.carries_shear

    @property
    def coulomb_coefficient(self) -> float | None:
        """The coefficient, where that one number bounds friction; None where it varies."""
        given = self.parameters.get("friction_coefficient")
        if "friction_law" in self.parameters or not isinstance(given, float | int):
            return None
        return float(given)


@dataclass(frozen=True, eq=False, kw_only=True)
class StepContact(Record):
    """A contact at the end of a load step.

    Attributes:
        name: That of the scene.
        regularisation_parameter: ε of the step, where it does not follow from pressures to come
            (length).
        quantities: Of this contact alone.
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset({"regularisation_parameter"})

    name: str
    regularisation_parameter: float | None = None
    quantities: Quantities


@dataclass(frozen=True, eq=False, kw_only=True)
class BranchContact(Record):
    """A contact in one of several answers.

    Attributes:
        name: That of the scene.
        quantities: Of this contact alone.
    """

    name: str
    quantities: Quantities


@dataclass(frozen=True, eq=False, kw_only=True)
class SupportRecord(Record):
    """A support, a plane of symmetry or the outer boundary of a half-space.

    Attributes:
        name: By default that of its group; several may have the same.
        on: The group.
        reaction: Resultant on the body, a vector (force).
        reaction_moment: Its moment about `moment_about` (force times length): in space a vector, in
            plane models a number.
        moment_about: The point that it is about, by default the centroid of `on` (length).
        displacement: Mean of what it holds along each axis, null along others, a vector (length).
        errors: Estimated errors of the reaction and its moment.
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset({"errors", "reaction_moment", "moment_about"})

    name: str
    on: str
    reaction: list[float]
    reaction_moment: list[float] | float | None = None
    moment_about: list[float] = field(default_factory=list)
    displacement: list[float | None] = field(default_factory=list)
    errors: Errors = field(default_factory=dict)

    @property
    def quantities(self) -> Quantities:
        """Quantities of the support, by name."""
        return _quantities_of_supports(self)


@dataclass(frozen=True, eq=False, kw_only=True)
class ReactionRecord(Record):
    """All supports of one name together.

    Attributes:
        reaction: Resultant on the body, a vector (force).
        reaction_moment: Its moment about their `moment_about` (force times length): in space a
            vector, in plane models a number.
        errors: Estimated errors of both.
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset({"errors", "reaction_moment"})

    reaction: list[float]
    reaction_moment: list[float] | float | None = None
    errors: Errors = field(default_factory=dict)

    @property
    def quantities(self) -> Quantities:
        """Quantities of all supports of the name, by name."""
        return _quantities_of_supports(self)


def _quantities_of_supports(found: SupportRecord | ReactionRecord) -> Quantities:
    """Quantities that supports have; in axisymmetric models they have no moments."""
    every = {name: getattr(found, name) for name in OF_SUPPORTS}
    return {name: value for name, value in every.items() if value is not None}


@dataclass(frozen=True, eq=False, kw_only=True)
class PreloadRecord(Record):
    """A preload.

    Attributes:
        on: The group of cells.
        force: Along the axis, > 0 where it is pulled; of the part that is modelled (force).
        elongation: By how much its unstressed length is shortened, > 0 when tightened (length).
        initial_strain: Its strain along the axis that is free of stress: less the elongation over
            its length.
        locked: Whether the unstressed length is that of an earlier load step.
        errors: Estimated errors of the force and the elongation.
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset({"errors"})

    on: str
    force: float
    elongation: float
    initial_strain: float
    locked: bool
    errors: Errors = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class CouplingRecord(Record):
    """A face that moves with a point.

    Attributes:
        name: That of the scene, by default that of the boundary.
        on: The boundary.
        kind: ``rigid``, or ``distributing``, whose face has the motion of the point in the mean.
        displacement: Of the point (length).
        rotation: Of the point (radian): about the three axes in space, one number in the plane,
            none in axisymmetric models.
        force: On the point, given or needed; of the part that is modelled (force).
        moment: The same about the point (force·length), likewise as the rotation.
        errors: Estimated errors of these.
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset({"errors"})

    name: str
    on: str
    kind: str
    displacement: list[float]
    rotation: list[float]
    force: list[float]
    moment: list[float]
    errors: Errors = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class SectorRecord(Record):
    """A sector of a ring, what acts across its cut, and numbers of the whole ring.

    Attributes:
        sectors: How many of them make the whole.
        axis: Unit vector along the axis.
        at: A point of it (length).
        jump: The largest jump of the displacement between the cut faces, one turned, over their
            largest displacement.
        force: Resultant on the cut face `on`, a vector (force).
        moment: Its moment about the axis (force times length).
        whole: Name → number of the whole ring: of quantities that add up over the sectors, and
            `torque` and in 3D `axial_force`, of the reactions of all supports about the axis and
            along it.
        couplings: Coupling → `torque` and in 3D `axial_force` of the forces on its copies in all
            sectors together.
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset({"couplings"})

    sectors: int
    axis: list[float]
    at: list[float]
    jump: float
    force: list[float]
    moment: float
    whole: Mapping[str, float]
    couplings: Mapping[str, Mapping[str, float]] = field(default_factory=dict)


#: The records of scalar unknowns that results name: one class for each kind.
ScalarRecord = PreloadRecord


@dataclass(frozen=True, eq=False, kw_only=True)
class SlipLimitRecord(Record):
    """How much friction there is against rigid slip, and how much of it is used.

    Attributes:
        parts: Part → how much of what friction can hold of it is used, all its contacts together
            and the other parts at rest, 0 … 1; null where supports hold it, or where no motion
            that they leave slips along all that touches.
        motion: The motion, of one part or several, against which most of it is used, in words; of
            an upper bound that which runs there; empty where there is none.
        factor: Factor of the loads that vary in the last load step at which a part slips as a
            whole, 1 for the present loads; null where it is not known.
        kind: How that was found: `pressures held` by the pressures of the answer, which loads that
            are 1 % larger leave as they are; `load steps` by larger and larger loads
            (`solver.slip_limit`); `upper bound` for any pressures at the points that may touch:
            at that factor a part slips or tips, and may before; empty where it is not known.
        errors: `factor` → estimated errors of it by source, with `solver.slip_limit = "steps"` and
            `errors = "all"`: by solving again with less of each.
    """

    parts: Mapping[str, float | None]
    motion: str = ""
    factor: float | None = None
    kind: str = ""
    errors: Errors = field(default_factory=dict)
