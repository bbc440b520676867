"""The numerical penalty of a law across a contact: how soft it is at present."""

from __future__ import annotations

from dolfinx import fem

from fenics_contact.contact.laws.site import LawSite


class Penalty:
    """How many times softer the springs of a law are than their own penalty makes them.

    Solvers take softer ones on the way to an answer, and stiffer ones tell its error. A law without
    a penalty has springs that are meant, which stay as they are.

    Attributes:
        exists: Whether the law's stiffness is a penalty.
        softness: By which factor its stiffness is divided at present.
        softness_in_ufl: The same for forms.

    Args:
        site: Where the law acts.
        exists: Whether the law's stiffness is a penalty.
    """

    def __init__(self, site: LawSite, exists: bool) -> None:
        self.exists, self.softness = exists, 1.0
        self.softness_in_ufl = fem.Constant(site.trace.surface.mesh, 1.0)

    def soften(self, factor: float) -> None:
        """Divide the stiffness by a factor, from now on, if it is a penalty.

        Args:
            factor: Over the law's own stiffness; 1 is that itself.
        """
        if self.exists:
            self.softness = self.softness_in_ufl.value = factor
