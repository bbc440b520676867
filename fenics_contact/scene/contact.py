"""The parts of a scene that say where contact may be: its laws, its obstacle, its wear."""

from __future__ import annotations

import dataclasses
from typing import Annotated, Literal, get_args

from pydantic import Field

from fenics_contact.scene.given_keys import FREE_AT_RESUME
from fenics_contact.scene.laws.friction_laws import AnyFrictionLaw
from fenics_contact.scene.laws.law_tables import NORMAL_LAWS, AnyNormalLaw, kinds_of
from fenics_contact.scene.loading.heat import Conductance
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.units.dimensions import (
    COMPLIANCE,
    CONDUCTANCE,
    LENGTH,
    PER_STRESS,
    PLACE,
    STIFFNESS,
    STRESS,
)
from fenics_contact.scene.values import (
    CONSTANT,
    PER_AXIS,
    RAMP,
    LoadPath,
    NotNegative,
    Number,
    Path,
    Text,
    Value,
    scene_class,
)


@scene_class
class Wear:
    """Archard's law: where a point slips by ds under a pressure p, the surfaces lose k p |ds|.

    What is lost widens the gap of the load steps that follow.

    >>> Wear(coefficient=1e-8).threshold
    0.0
    """

    coefficient: Annotated[
        Value,
        PER_STRESS,
        Field(
            description="k ≥ 0: worn volume over force and way, of both surfaces together "
            "(hardness is in it)"
        ),
    ]
    threshold: Annotated[
        Annotated[Number, Field(ge=0)],
        STRESS,
        Field(description="pressure up to which nothing is worn; beyond, what exceeds it wears"),
    ] = 0.0

    share: Annotated[
        Annotated[Number, Field(ge=0, le=1)] | None,
        FREE_AT_RESUME,
        Field(
            description="between bodies: part of the depth that the surface `on` loses, the other "
            "loses the rest; by default nothing is said of which has lost how much"
        ),
    ] = None

    def __post_init__(self) -> None:
        if isinstance(self.coefficient, float | int) and self.coefficient < 0:
            raise ValueError(f"coefficient = {self.coefficient} must be ≥ 0")


Kind = Literal["prescribed", "unilateral", "winkler", "bonded"]


@scene_class
class Contact:
    """A contact surface (the paper's Γ_C): what it meets there, and friction.

    >>> Contact("bottom", friction_coefficient=0.3).kind
    'unilateral'
    >>> Contact("top", pressure=lambda x: 200 + 25 * x[0], friction_coefficient=0.3).kind
    'prescribed'
    >>> Contact("bottom", foundation_stiffness=100).kind
    'winkler'
    """

    on: Annotated[Text, Field(description="physical group of the contact surface")]
    pressure: Annotated[
        Value | None,
        STRESS,
        Field(description="of `prescribed` contact, ≥ 0, which also loads the body"),
    ] = None
    pressure_path: Annotated[
        LoadPath,
        Field(
            description="of that pressure over the load steps, factors ≥ 0; load and friction "
            "bound follow it; by default it acts from the start"
        ),
    ] = CONSTANT
    name: Annotated[str, Field(description="name in the results; by default that of the group")] = (
        ""
    )
    contact: Annotated[
        Kind | None,
        Field(
            description="`prescribed`: its pressure is given; `unilateral`: an obstacle that the "
            "body may leave but not enter; `winkler`: the same on springs; `bonded`: glued to it; "
            "by default `prescribed` where there is a pressure, `winkler` where there is a "
            "foundation_stiffness, else `unilateral`"
        ),
    ] = None
    obstacle: Annotated[
        Obstacle | None,
        Field(description="what stands against it; by default it touches everywhere, and is fixed"),
    ] = None
    against: Annotated[
        Text | None,
        Field(
            description="instead of an obstacle: physical group of the surface opposite, of "
            "another body or of the same one; meshes need not match"
        ),
    ] = None
    slave: Annotated[
        Literal["auto", "on", "against"],
        Field(
            description="of two surfaces, the one whose points contact acts at, and `contact.csv` "
            "has; `auto` takes the one that the other covers, not a much finer one"
        ),
    ] = "auto"
    penalty_parameter: Annotated[
        NotNegative | Literal["auto"],
        COMPLIANCE,
        Field(
            description="the paper's ε₁ of `unilateral` and `bonded` contact: penetration over "
            "pressure; `auto` keeps its bias below .1 %, 0 solves the contact exactly"
        ),
    ] = "auto"
    foundation_stiffness: Annotated[
        Value | None,
        STIFFNESS,
        Field(description="of a `winkler` foundation, ≥ 0: pressure over depth"),
    ] = None
    normal_law: Annotated[
        AnyNormalLaw | None,
        Field(description="in place of `contact`: a law of the pressure with keys of its own"),
    ] = None
    interference: Annotated[
        Number,
        LENGTH,
        Field(
            description="by how much the two sides overlap along the normal before they are "
            "pressed apart, as in a press fit, beside what their meshes do; < 0 is a gap"
        ),
    ] = 0.0
    interference_path: Annotated[
        LoadPath, Field(description="of the interference over the load steps")
    ] = RAMP
    wear: Annotated[
        Wear | None,
        Field(
            description="what slip under pressure wears off, load step by load step; by default "
            "nothing; needs the incremental law where there is friction"
        ),
    ] = None
    law: Annotated[
        Literal["static", "incremental", "none"],
        Field(
            description="friction law: `static` acts on the total displacement (the paper's), "
            "`incremental` on the slip since the last load step (Coulomb's)"
        ),
    ] = "static"
    friction_coefficient: Annotated[
        Value, Field(description="Coulomb's coefficient, ≥ 0; 0 leaves friction out")
    ] = 0.0
    friction_law: Annotated[
        AnyFrictionLaw | None,
        Field(description="how large friction may be, with keys of its own; by default Coulomb's"),
    ] = None
    regularisation_parameter: Annotated[
        NotNegative | Literal["auto"],
        LENGTH,
        Field(
            description="the paper's ε, a slip; `auto` keeps its bias below .1 %, 0 solves "
            "friction exactly"
        ),
    ] = "auto"
    axis: Annotated[
        Annotated[tuple[Number, ...], PER_AXIS] | None,
        Field(
            description="in space: direction of the axis about which the quantity `torque` is, of "
            "any length; it leads through `moment_about`"
        ),
    ] = None
    moment_about: Annotated[
        Annotated[tuple[Annotated[Number, PLACE], ...], PER_AXIS] | None,
        Field(
            description="point that the moments of the contact are about; by default the centroid "
            "of `on`; in plane models the quantity `torque` needs it"
        ),
    ] = None
    conductance: Annotated[
        Annotated[Number, Field(ge=0)] | Conductance | None,
        CONDUCTANCE,
        Field(
            description="between two bodies, in scenes with `[[heat]]`: heat flow over area and "
            "difference of temperature where they touch, a number or `{ pressures, values }`; by "
            "default no heat crosses"
        ),
    ] = None

    def __post_init__(self) -> None:
        if self.normal_law is not None and self.contact is not None:
            raise ValueError(f"contact: the normal_law says that it is {self.normal_law.kind}")
        if self.axis is not None and not any(self.axis):
            raise ValueError("axis = 0: give the direction of the axis")
        needed = _NEEDS.get(self.kind)
        if needed is not None and getattr(self, needed) is None:
            raise ValueError(f"{needed} is missing: {self.kind} contact needs it")
        if self.against is not None and (self.pressure is not None or self.obstacle is not None):
            other = "an obstacle" if self.pressure is None else "a pressure that is given"
            raise ValueError(f"against: a contact has either a surface opposite or {other}")
        if self.against == self.on:
            raise ValueError(f"against = '{self.on}': a surface cannot stand against itself")
        if self.against is None and self.slave != "auto":
            raise ValueError("slave: only contact of two surfaces has one; see against")
        for key, (kinds, words) in _ONLY_IN.items():
            if self.kind not in kinds and getattr(self, key) != _DEFAULTS[key]:
                raise ValueError(f"{key}: {words.format(kind=self.kind)}")
        for key, (kind, words) in _NOT_IN.items():
            if self.kind == kind and getattr(self, key) != _DEFAULTS[key]:
                raise ValueError(f"{key}: {words}")
        self._require_fit()
        if self.friction_law is not None:
            self.friction_law.require_fit(self.kind, self.friction_coefficient)
            if self.friction_law.needs_steps and self.law != "incremental":
                raise ValueError(
                    f"law = '{self.law}': {self.friction_law.kind} friction follows the slip of "
                    "load steps, which needs law = 'incremental'"
                )
            if self.friction_law.is_regular and self.regularisation_parameter != "auto":
                raise ValueError(
                    f"regularisation_parameter: {self.friction_law.kind} friction has none, as its "
                    "elastic_slip is a property of the surfaces; leave it out"
                )
        if self.wear is not None and self.is_rough and self.law != "incremental":
            raise ValueError(
                f"law = '{self.law}': wear follows the slip of load steps, which with friction "
                "needs law = 'incremental'"
            )
        if isinstance(self.pressure_path, Path) and min(self.pressure_path.factor) < 0:
            raise ValueError("pressure_path: the factors must be ≥ 0, contact does not pull")
        for key in ("pressure", "friction_coefficient", "foundation_stiffness"):
            value = getattr(self, key)
            if isinstance(value, float | int) and value < 0:
                raise ValueError(f"{key} = {value} must be ≥ 0")

    def _require_fit(self) -> None:
        """Refuse wear or an interference without a gap, or whose obstacle moves freely."""
        if self.wear is not None and self.kind in ("prescribed", "bonded"):
            raise ValueError(f"wear: {self.kind} contact has no gap that could be widened")
        if self.wear is not None and self.wear.share is not None and self.against is None:
            raise ValueError(
                "wear.share: what is lost is shared between two bodies, and nothing stands against "
                "this one; leave share out, or give against"
            )
        if not self.interference:
            if self.interference_path != RAMP:
                raise ValueError("interference_path: only an interference that is given has one")
            return
        given = f"interference = {self.interference:g}"
        if self.kind in ("prescribed", "bonded"):
            raise ValueError(f"{given}: {self.kind} contact has no gap that could be narrowed")
        if self.obstacle is not None and self.obstacle.force is not None:
            raise ValueError(
                f"{given}: the obstacle goes as deep as its force drives it; give "
                "obstacle.indentation instead of the force, or no interference"
            )

    @property
    def kind(self) -> str:
        """Kind of the law across the contact, given or implied by the other keys."""
        if self.normal_law is not None:
            return self.normal_law.kind
        if self.contact is not None:
            return self.contact
        given = (kind for kind, key in _NEEDS.items() if getattr(self, key) is not None)
        return next(given, "unilateral")

    @property
    def is_exact(self) -> bool:
        """Whether it asks for no penalty or no smoothing of friction at all."""
        return 0 in (self.penalty_parameter, self.regularisation_parameter)

    @property
    def exact_parameters(self) -> tuple[float, float]:
        """Parameters ε₁ and ε of an exact solve, as they are given, by default 0."""
        given = self.penalty_parameter, self.regularisation_parameter
        first, second = (0.0 if value == "auto" else float(value) for value in given)
        return first, second

    @property
    def fits_motion(self) -> bool:
        """Whether the law across it is one that bodies in motion may have."""
        return self.normal_law is None or self.normal_law.fits_motion

    @property
    def coulomb_coefficient(self) -> float | None:
        """The coefficient, where that one number bounds friction; None where it varies."""
        given, law = self.friction_coefficient, self.friction_law
        is_plain = law is None or law.is_proportional
        return float(given) if is_plain and isinstance(given, float | int) else None

    @property
    def is_rough(self) -> bool:
        """Whether it has friction, as far as the scene says it without the points."""
        return self.friction_coefficient != 0 or self.friction_law is not None

    @property
    def label(self) -> str:
        """Name in results and messages."""
        return self.name or self.on


def kinds_in_motion() -> list[str]:
    """Kinds of contact that bodies in motion may have."""
    tables = [table for table in NORMAL_LAWS.tables if table.fits_motion]
    return [*get_args(Kind), *(kind for table in tables for kind in kinds_of(table))]


# The key without which there is no contact of a kind, and which says that it is one.
_NEEDS = {"winkler": "foundation_stiffness", "prescribed": "pressure"}
# Keys that only contact of some kinds has, or that of one kind has not, and what to say then.
_ONLY_IN = {
    "pressure": (("prescribed",), "in {kind} contact it is found, not given"),
    "pressure_path": (("prescribed",), "only a pressure that is given has one"),
    "foundation_stiffness": (("winkler",), "it belongs to winkler contact, and only there"),
    "penalty_parameter": (("unilateral", "bonded"), "{kind} contact has none"),
}
_NOT_IN = {
    "obstacle": ("prescribed", "prescribed contact has none, only its pressure"),
    "friction_coefficient": ("bonded", "bonded contact sticks, it has none"),
    "friction_law": ("bonded", "bonded contact sticks, it has none"),
}
_DEFAULTS = {field.name: field.default for field in dataclasses.fields(Contact)}
