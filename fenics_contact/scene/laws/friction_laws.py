"""How large friction may be: tables of their own in a scene, ``contact.friction_law``.

A new one is a class here: what it says of itself are its keys.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field

from fenics_contact.scene.laws.law_tables import (
    LANGUAGE,
    ClassName,
    FrictionLawTable,
    Parameters,
    TablesByKind,
    require_formula,
    require_increase,
)
from fenics_contact.scene.units.dimensions import LENGTH, STIFFNESS_OF_POWER, STRESS, VELOCITY
from fenics_contact.scene.values import Number, Positive, Text, Value, scene_class

_Shares = Annotated[
    tuple[Annotated[Number, Field(ge=0)], ...],
    Field(
        min_length=2,
        max_length=20,
        description="share of the friction_coefficient at each; constant beyond the ends",
    ),
]


@scene_class
class CoulombFriction(FrictionLawTable):
    """Coulomb's friction, bounded by the friction coefficient times the pressure: the default.

    >>> CoulombFriction(kind="coulomb").kind
    'coulomb'
    """

    is_proportional: ClassVar[bool] = True
    kind: Annotated[Literal["coulomb"], Field(description="which law it is")]


@scene_class
class NonlocalFriction(FrictionLawTable):
    """Nonlocal friction: Coulomb's, of the pressure averaged around each point (Duvaut 1980).

    >>> NonlocalFriction(kind="nonlocal", averaging_radius=0.3).averaging_radius
    0.3
    """

    averages: ClassVar[bool] = True
    kind: Annotated[Literal["nonlocal"], Field(description="which law it is")]
    averaging_radius: Annotated[
        Positive,
        LENGTH,
        Field(
            description="ρ up to which pressures along the surface are averaged; where cells are "
            "larger, it is Coulomb's law"
        ),
    ]


@scene_class
class MicroSlipFriction(FrictionLawTable):
    """Friction with micro-slip: up to an elastic slip surfaces give way along each other.

    From there on they slide under Coulomb's bound (Oden and Pires 1983). With the incremental law
    the elastic slip goes back as the traction does, and the rest stays.

    >>> MicroSlipFriction(kind="micro-slip", elastic_slip=1e-3).shown
    'micro-slip: elastic_slip 0.001'
    """

    is_regular: ClassVar[bool] = True
    kind: Annotated[Literal["micro-slip"], Field(description="which law it is")]
    elastic_slip: Annotated[
        Positive,
        LENGTH,
        Field(
            description="the slip at which friction reaches its bound, a property of the surfaces; "
            "it is not the `regularisation_parameter`, which stands for none"
        ),
    ]


@scene_class
class ComplianceFriction(FrictionLawTable):
    """Friction of surfaces that give way: c d^m at a depth d (Oden and Martins 1985).

    It belongs to contact by normal compliance or on a Winkler foundation, and stands in place of
    a friction coefficient.

    >>> ComplianceFriction(kind="compliance", coefficient=1e4, exponent=2).shown
    'compliance: coefficient 1e+04, exponent 2'
    """

    kind: Annotated[Literal["compliance"], Field(description="which law it is")]
    coefficient: Annotated[
        Value,
        STIFFNESS_OF_POWER,
        Field(description="c ≥ 0 of the largest friction traction; 0 leaves friction out"),
    ]
    exponent: Annotated[Number, Field(ge=1, description="m ≥ 1")]

    def __post_init__(self) -> None:
        if isinstance(self.coefficient, float | int) and self.coefficient < 0:
            raise ValueError(f"coefficient = {self.coefficient} must be ≥ 0")

    def require_fit(self, kind: str, coefficient: Value) -> None:
        """It needs a depth, and no friction coefficient.

        Args:
            kind: The law across the contact, as results name it.
            coefficient: The contact's friction_coefficient.

        Raises:
            ValueError: It is of another contact.
        """
        if kind not in ("normal compliance", "winkler"):
            raise ValueError(
                f"friction_law: compliance follows the depth of normal compliance or of a winkler "
                f"foundation, but the contact is {kind}"
            )
        if coefficient != 0:
            raise ValueError(
                "friction_coefficient: friction by compliance has a coefficient of its own, in "
                "friction_law"
            )


@scene_class
class PressureDependentFriction(FrictionLawTable):
    """Coulomb's friction with a coefficient that depends on the pressure, by a table.

    >>> law = PressureDependentFriction(
    ...     kind="pressure dependent", pressures=(0, 100), shares=(1, 0.6))
    >>> law.shares
    (1.0, 0.6)
    """

    kind: Annotated[Literal["pressure dependent"], Field(description="which law it is")]
    pressures: Annotated[
        tuple[Annotated[Number, STRESS], ...],
        Field(min_length=2, max_length=20, description="increasing contact pressures, ≥ 0"),
    ]
    shares: _Shares

    def __post_init__(self) -> None:
        require_increase("pressures", self.pressures, self.shares)


@scene_class
class SlipDependentFriction(FrictionLawTable):
    """Coulomb's friction with a coefficient that depends on how far a point has slid, by a table.

    Weakening, or running-in. It needs the incremental law, whose load steps it counts.

    >>> SlipDependentFriction(kind="slip dependent", slips=(0, 0.1), shares=(1, 0.6)).shares
    (1.0, 0.6)
    """

    needs_steps: ClassVar[bool] = True
    kind: Annotated[Literal["slip dependent"], Field(description="which law it is")]
    slips: Annotated[
        tuple[Annotated[Number, LENGTH], ...],
        Field(min_length=2, max_length=20, description="increasing lengths of slip so far, ≥ 0"),
    ]
    shares: _Shares

    def __post_init__(self) -> None:
        require_increase("slips", self.slips, self.shares)


@scene_class
class SpeedDependentFriction(FrictionLawTable):
    """Coulomb's friction with a coefficient that depends on how fast points slide, by a table.

    The friction coefficient is that at rest. Where it falls with the speed, bodies stick and slip
    by turns. It is for scenes that move.

    >>> SpeedDependentFriction(kind="speed dependent", speeds=(0, 10), shares=(1, 0.6)).shares
    (1.0, 0.6)
    """

    needs_motion: ClassVar[bool] = True
    kind: Annotated[Literal["speed dependent"], Field(description="which law it is")]
    speeds: Annotated[
        tuple[Annotated[Number, VELOCITY], ...],
        Field(min_length=2, max_length=20, description="increasing speeds of sliding, ≥ 0"),
    ]
    shares: _Shares

    def __post_init__(self) -> None:
        require_increase("speeds", self.speeds, self.shares)
        if self.shares[0] != 1:
            raise ValueError(
                f"shares[0] = {self.shares[0]:g} must be 1, as friction_coefficient is that at rest"
            )

    @property
    def at_rest(self) -> None:
        """Coulomb's, whose coefficient is that of the contact."""
        return None


@scene_class
class OrthotropicFriction(FrictionLawTable):
    """Coulomb's friction with two coefficients, along a direction of the surface and across it.

    It stands in place of a friction coefficient, in 3D models.

    >>> law = OrthotropicFriction(
    ...     kind="orthotropic", along=0.2, across=0.5, direction=(1, 0, 0))
    >>> law.shown
    'orthotropic: along 0.2, across 0.5, direction [1, 0, 0]'
    """

    kind: Annotated[Literal["orthotropic"], Field(description="which law it is")]
    along: Annotated[
        Value, Field(description="friction coefficient of sliding along the direction, > 0")
    ]
    across: Annotated[
        Value,
        Field(description="that of sliding along the surface at right angles to it, > 0"),
    ]
    direction: Annotated[
        tuple[Number, Number, Number],
        Field(
            description="such as that of grinding; of any length; what of it lies along the "
            "surface counts, at each point"
        ),
    ]

    def __post_init__(self) -> None:
        for key in ("along", "across"):
            value = getattr(self, key)
            if isinstance(value, float | int) and value <= 0:
                raise ValueError(f"{key} = {value:g} must be > 0")
        if not any(self.direction):
            raise ValueError("direction must not be a zero vector")

    def require_model(self, kinematics: str, key: str) -> None:
        """There are two directions to slide in.

        Args:
            kinematics: Of the scene.
            key: Of the contact, for messages.

        Raises:
            ValueError: There are not.
        """
        if kinematics != "3D":
            raise ValueError(
                f"{key}.friction_law: orthotropic friction is for 3D models; in a {kinematics} "
                "model points slide along one line, with one friction_coefficient"
            )

    def require_fit(self, kind: str, coefficient: Value) -> None:
        """It needs no friction coefficient.

        Args:
            kind: The law across the contact, as results name it.
            coefficient: The contact's friction_coefficient.

        Raises:
            ValueError: There is one.
        """
        if coefficient != 0:
            raise ValueError(
                "friction_coefficient: orthotropic friction has coefficients of its own, in "
                "friction_law"
            )


@scene_class
class FormulaFriction(FrictionLawTable):
    """A bound of friction of your own: a formula of the pressure p and the coefficient mu.

    >>> law = FormulaFriction(
    ...     kind="formula", bound="mu * p / (1 + p / p0)", parameters={"p0": 50.0})
    >>> law.shown
    'formula: bound mu * p / (1 + p / p0), p0 50'
    """

    kind: Annotated[Literal["formula"], Field(description="which law it is")]
    bound: Annotated[
        Text,
        Field(
            description="the largest friction traction at a pressure `p`, 0 at p = 0; `mu` is the "
            f"friction_coefficient; {LANGUAGE}"
        ),
    ]
    parameters: Parameters = Field(default_factory=dict)

    def __post_init__(self) -> None:
        require_formula("bound", self.bound, self.parameters, {"p": 0.0, "mu": 1.0})


@scene_class
class OwnFrictionLaw(FrictionLawTable):
    """A law of a module of yours, which the command line must allow: ``--laws MODULE``.

    >>> OwnFrictionLaw(kind="my_laws:Saturated", parameters={"p0": 50}).shown
    'my_laws:Saturated: p0 50'
    """

    kind: Annotated[ClassName, Field(description="`MODULE:CLASS`, derived from `UserFriction`")]
    parameters: Parameters = Field(default_factory=dict)


#: All of them, of which there can be more later.
FRICTION_LAWS = TablesByKind(*FrictionLawTable.__subclasses__())
if TYPE_CHECKING:
    AnyFrictionLaw = FrictionLawTable
else:
    AnyFrictionLaw = Annotated[Any, FRICTION_LAWS]
