"""What every law of a contact answers, be it across the contact or along it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from fenics_contact.body.forms import CompiledForm
from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.earlier_names import keep_earlier_names
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.contact.state import ContactState
from fenics_contact.contact.surface.averaging import SurfaceAverage
from fenics_contact.results.point_arrays import PointArray

# What a law says twice: by forms, and at the points.
_TOGETHER = (
    ("force", "at_points"),
    ("tangents", "tangent_at_points"),
    ("loads", "loads_at_points"),
)
_EARLIER_NAMES = {"pulled_back": "vjp", "says_it_at_points": "is_pointwise"}


def defined_in_same_class(law: object, *names: str) -> bool:
    """Whether one class says what some attributes of a law are: then they fit each other."""
    classes = type(law).__mro__
    return len({next((c for c in classes if name in vars(c)), None) for name in names}) == 1


class ContactLaw:
    """A law; this one exerts nothing, and others say what they do instead.

    Attributes:
        kind: As scenes and results name it.
        model: What it models, in words.
        checks: Names of the checks of ``trust/checks/run_checks.py`` that judge it.
        state: Arrays at the points that it keeps from load step to load step, its attributes.
            They are saved, gone back to, restarted, written and drawn by what is said here.
        follows_jump: Whether it exerts forces that follow the jump, so that it has forms.
        name: What is modelled where, for results.

    Args:
        site: Where it acts.
    """

    kind: ClassVar[str] = ""
    model: ClassVar[str] = ""
    checks: tuple[str, ...] = ()
    state: tuple[PointArray, ...] = ()
    follows_jump: ClassVar[bool] = False

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        keep_earlier_names(cls, _EARLIER_NAMES)

    def __init__(self, site: LawSite) -> None:
        self.site = site
        self.name = f"{self.model} on {site.contact.label}"

    def shown(self, state: ContactState) -> dict[str, Array]:
        """Arrays of ``state`` of which results have other numbers than what is kept, by name.

        Args:
            state: What happens at the points.
        """
        return {}

    @property
    def called(self) -> str:
        """What messages call it."""
        return f"law '{self.kind}'"

    @property
    def forms(self) -> tuple[CompiledForm, ...]:
        """Compiled forms of the forces that follow the jump; none where nothing does.

        They are compiled when they are first asked for.
        """
        return ()

    @property
    def tangents(self) -> tuple[CompiledForm, ...]:
        """Forms of the tangent in the present mode."""
        return ()

    @property
    def is_pointwise(self) -> bool:
        """Whether its numbers at the points are made along with its forms.

        Those of a law that has other forms than the one it derives from need not be its own.
        """
        return all(defined_in_same_class(self, one, other) for one, other in _TOGETHER)

    @property
    def has_derivatives(self) -> bool:
        """Whether ``vjp`` is of its own numbers, and nothing else is kept between steps."""
        keeps = {array.name for array in self.state} - self.derived_state
        own = defined_in_same_class(self, "vjp", "at_points")
        return not keeps and (not self.follows_jump or (own and self.is_pointwise))

    @property
    def derived_state(self) -> set[str]:
        """Names of arrays of ``state`` by which derivatives go back to load steps before."""
        return {"reference", "bound"}

    def force(self) -> Array:
        """Forces on the body at all nodes of the surface, (nodes, components); collective."""
        trace = self.site.trace
        return np.zeros((len(trace.all_nodes), trace.surface.components))

    def at_points(self) -> Array:
        """Traction on the body at the points, (points, components) (stress).

        Of the same energy as ``force``: on nodal points, what that gives over their areas.
        """
        return np.zeros_like(self.site.trace.normals)

    def tangent_at_points(self) -> Array:
        """Minus its derivative in the jump, as the forms of ``tangents`` have it.

        Shape (points, components, components) (stress/length).
        """
        normals = self.site.trace.normals
        return np.zeros((*normals.shape, normals.shape[1]))

    @property
    def neighbours(self) -> SurfaceAverage | None:
        """What makes its forces at a point follow the jump at others; None where nothing does."""
        return None

    def tangent_between_points(self) -> Array:
        """Minus the derivative of its traction in the jump at other points; collective.

        Of each pair of ``neighbours``, beside ``tangent_at_points``, (pairs, components,
        components) (stress/length).
        """
        size = self.site.trace.normals.shape[1]
        return np.zeros((0, size, size))

    def kept(self) -> dict[str, Array]:
        """The arrays of ``state`` as they are, by name."""
        return {array.name: getattr(self, array.name).copy() for array in self.state}

    def recall(self, at_points: Mapping[str, Array]) -> None:
        """Take back the arrays of ``state``, whatever has been tried since.

        Args:
            at_points: As they were remembered, among others.
        """
        for array in self.state:
            setattr(self, array.name, at_points[array.name].copy())

    def at_step_end(self, state: ContactState) -> dict[str, Array]:
        """The arrays of ``state`` that a load step changes, as they are at its end, by name.

        Args:
            state: What happens at the points then. The law's own arrays are those of its begin.
        """
        return {}

    def advance(self, state: ContactState) -> None:
        """A load step is done: keep its arrays as they are at its end.

        Args:
            state: As of ``at_step_end``.
        """
        for name, values in self.at_step_end(state).items():
            setattr(self, name, values)


keep_earlier_names(ContactLaw, _EARLIER_NAMES)
