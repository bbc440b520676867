"""A contact whose pressure is given: a load, and the bound of friction (paper, (1.8))."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import ClassVar

import numpy as np
import ufl

from fenics_contact.body.forms import CompiledForm
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import largest
from fenics_contact.contact.laws.energies import prescribed_pressure_energy
from fenics_contact.contact.laws.normal.law import GivenLoad, NormalLaw, Parameter
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.scene.contact import Contact


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
