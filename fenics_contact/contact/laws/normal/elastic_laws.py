"""Laws of an elastic energy, a contact whose pressure is given, and one that no force drives."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import ClassVar

import numpy as np
import ufl
from dolfinx.fem import Form as CompiledForm
from ufl.core.expr import Expr

from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import largest
from fenics_contact.contact.laws.energies import prescribed_pressure_energy
from fenics_contact.contact.laws.normal.energy_law import EnergyLaw, PenaltyLaw
from fenics_contact.contact.laws.normal.law import GivenLoad, NormalLaw, Parameter
from fenics_contact.contact.laws.normal.spring import positive
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.laws import law_tables
from fenics_contact.scene.values import Value


class Unilateral(PenaltyLaw):
    """ψ = ⟨d⟩²/(2ε₁): the pressure is the penetration over ε₁ (paper, (4.1))."""

    kind: ClassVar[str] = "unilateral"
    model: ClassVar[str] = "unilateral contact (penalty)"
    exact_model: ClassVar[str] = "unilateral contact"

    @staticmethod
    def density(depth: Expr, jump: Expr, **fields: Expr) -> Expr:
        """½ k ⟨d⟩², k = 1/ε₁."""
        return 0.5 * fields["stiffness"] * positive(depth) ** 2


class Foundation(EnergyLaw):
    """ψ = ½ k ⟨d⟩² with the stiffness k of the foundation (E. Winkler, 1867)."""

    kind: ClassVar[str] = "winkler"
    model: ClassVar[str] = "Winkler foundation"
    names_of_power: ClassVar[tuple[str, ...]] = ("stiffness",)

    @classmethod
    def parameters(cls, contact: Contact) -> dict[str, Parameter]:
        """The stiffness as the scene gives it (stress/length)."""
        return {"foundation_stiffness": contact.foundation_stiffness}

    def fields(self) -> Mapping[str, Array]:
        """The stiffness k (stress/length)."""
        given = self.site.contact.foundation_stiffness or 0.0
        return {"stiffness": self.site.given(given, "foundation_stiffness")}

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Slopes of the stiffness in that of the scene."""
        return {"stiffness": self.site.given(unit, key)} if key == "foundation_stiffness" else {}

    @property
    def power_of_depth(self) -> tuple[Array, Array]:
        """K and 1."""
        stiffness = self._fields["stiffness"]
        return stiffness, np.ones(len(stiffness))

    @staticmethod
    def density(depth: Expr, jump: Expr, **fields: Expr) -> Expr:
        """½ k ⟨d⟩²."""
        return 0.5 * fields["stiffness"] * positive(depth) ** 2


class NormalCompliance(EnergyLaw):
    """p = c ⟨d⟩^m at a depth d = −gap, of which ψ = c ⟨d⟩^(m + 1)/(m + 1) is the energy.

    J. T. Oden, J. A. C. Martins, Models and computational methods for dynamic friction phenomena,
    Computer Methods in Applied Mechanics and Engineering 52 (1985) 527-634, Section 2.
    """

    kind: ClassVar[str] = "normal compliance"
    model: ClassVar[str] = "normal compliance"
    names_of_power: ClassVar[tuple[str, ...]] = ("coefficient", "exponent")

    @classmethod
    def parameters(cls, contact: Contact) -> dict[str, Parameter]:
        """The coefficient c (stress/length^m) and the exponent m."""
        given = _table(contact)
        return {"coefficient": given.coefficient, "exponent": given.exponent}

    def fields(self) -> Mapping[str, Array]:
        """Both at the points."""
        given = _table(self.site.contact)
        coefficient = self.site.given(given.coefficient, "normal_law.coefficient")
        return {"coefficient": coefficient, "exponent": np.full(len(coefficient), given.exponent)}

    @property
    def power_of_depth(self) -> tuple[Array, Array]:
        """Both at the points."""
        return self._fields["coefficient"], self._fields["exponent"]

    @staticmethod
    def density(depth: Expr, jump: Expr, **fields: Expr) -> Expr:
        """The density c ⟨d⟩^(m + 1)/(m + 1)."""
        power = fields["exponent"] + 1
        return fields["coefficient"] * positive(depth) ** power / power


def _table(contact: Contact) -> law_tables.NormalCompliance:
    law = contact.normal_law
    assert isinstance(law, law_tables.NormalCompliance)
    return law


class Bonded(PenaltyLaw):
    """ψ = |w|²/(2ε₁): what stands opposite is glued on as it stands, whatever the gap."""

    kind: ClassVar[str] = "bonded"
    model: ClassVar[str] = "bonded contact (penalty)"
    exact_model: ClassVar[str] = "bonded contact"
    sticks: ClassVar[bool] = True
    pushes_only: ClassVar[bool] = False
    checks: tuple[str, ...] = ("penetration_depth",)

    def fields(self) -> Mapping[str, Array]:
        """1/ε₁ where something stands opposite."""
        stiffness = np.where(self.site.kinematics.reached, 1 / self._penalty, 0.0)
        return {"stiffness": stiffness}

    @staticmethod
    def density(depth: Expr, jump: Expr, **fields: Expr) -> Expr:
        """½ k |w|²."""
        return 0.5 * fields["stiffness"] * ufl.dot(jump, jump)

    def depth(self, jump: Array) -> Array:
        """w_n: no gap counts."""
        kinematics = self.site.kinematics
        return np.where(kinematics.reached, kinematics.normal(jump), -np.inf)

    def stiffness(self, depth: Array) -> Array:
        """The stiffness 1/ε₁ at the points (stress/length)."""
        return self._fields["stiffness"] / self.penalty.softness

    def is_closed(self, pressure: Array) -> Flags:
        """All that is glued on."""
        return self.site.kinematics.reached

    def touches_at_rest(self) -> Flags:
        """All that is glued on."""
        return self.site.kinematics.reached


class Prescribed(NormalLaw):
    """σ_n = −p: a pressure that acts on the body whatever it does (paper, (1.8))."""

    kind: ClassVar[str] = "prescribed"
    model: ClassVar[str] = "contact pressure"
    has_counterpart: ClassVar[bool] = False
    pressure_is_known: ClassVar[bool] = True

    def __init__(self, site: LawSite) -> None:
        super().__init__(site)
        self._in_full = site.given(site.contact.pressure or 0.0, "pressure")
        self._present = self._in_full
        self._acts = largest(site.trace.spaces.comm, self._in_full) > 0

    @cached_property
    def _work(self) -> CompiledForm:
        """The work f on Γ_C as a linear form: minus the derivative of ∫ p v_n."""
        trace = self.site.trace
        pressure = trace.coefficient(self._in_full)
        test = ufl.TestFunction(trace.surface.space)
        work = prescribed_pressure_energy(test, trace.normal, pressure, trace.weight, trace.measure)
        return form_cache.form(-work)

    @classmethod
    def parameters(cls, contact: Contact) -> dict[str, Parameter]:
        """The pressure as the scene gives it (stress)."""
        return {"pressure": contact.pressure}

    @property
    def is_load(self) -> bool:
        """Whether the pressure is > 0 anywhere."""
        return self._acts

    @property
    def loads(self) -> list[GivenLoad]:
        """The pressure's work."""
        return [(self._work, self.site.paths.pressure_factor)] if self._acts else []

    @property
    def loads_at_points(self) -> list[tuple[Array, Callable[[float], float]]]:
        """Tractions of the pressure at the points, with the share that acts at a pseudo-time."""
        if not self._acts:
            return []
        traction = -self._in_full[:, None] * self.site.trace.normals
        return [(traction, self.site.paths.pressure_factor)]

    def set_time(self, time: float) -> None:
        """Take the share of the pressure that acts at a pseudo-time."""
        self._present = self.site.paths.pressure_factor(time) * self._in_full

    def depth(self, jump: Array) -> Array:
        """No depth is known."""
        return np.zeros(len(jump))

    def pressure(self, jump: Array) -> Array:
        """The pressure that acts at present, (points,) (stress)."""
        return self._present

    def touches_at_rest(self) -> Flags:
        """Where it presses."""
        return self._present > 0


class Untouched(NormalLaw):
    """p = 0: what the body may leave, and no force drives, is where it just touches."""

    kind: ClassVar[str] = "untouched"
    model: ClassVar[str] = "an obstacle that nothing drives"
    pressure_is_known: ClassVar[bool] = True
