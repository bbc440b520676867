"""The base of every law of a contact, and of forces with their tangents, as solvers use them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
from dolfinx.fem import Form as CompiledForm

from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.contact.state import ContactState
from fenics_contact.contact.surface.averaging import SurfaceAverage
from fenics_contact.results.contact_points import PointArray

_EARLIER_NAMES = {"pulled_back": "vjp", "says_it_at_points": "is_pointwise"}


def defined_in_same_class(law: object, *names: str) -> bool:
    """Whether one class says what some attributes of a law are: then they fit each other."""
    classes = type(law).__mro__
    return len({next((c for c in classes if name in vars(c)), None) for name in names}) == 1


def name_in_table(key: str, table: str) -> str:
    """Name of the number under a key of a law's own table; empty for other keys of the contact.

    Args:
        key: Of a number of the contact.
        table: The law's, ``normal_law`` or ``friction_law``.

    >>> name_in_table("friction_law.parameters.p0", "friction_law")
    'p0'
    >>> name_in_table("normal_law.exponent", "normal_law"), name_in_table("p0", "normal_law")
    ('exponent', '')
    """
    of, _, name = key.partition(".")
    return name.removeprefix("parameters.") if of == table else ""


def keep_earlier_names(law: type, names: Mapping[str, str]) -> None:
    """Let a class answer, and override, by the earlier names of its methods, too.

    Args:
        law: A class, called with each one that is derived.
        names: Earlier name → present name.
    """
    own = vars(law)
    for earlier, name in names.items():
        if name in own:
            setattr(law, earlier, own[name])
        elif earlier in own:
            setattr(law, name, own[earlier])


class ContactLaw:
    """A law of a contact: its names, and the arrays that it keeps from load step to load step.

    Attributes:
        kind: As scenes and results name it.
        model: What it models, in words.
        exact_model: The same of an answer that has neither penalty nor smoothing; empty where
            these are no part of it.
        checks: Names of the checks of ``trust/run_checks.py`` that judge it.
        state: Arrays at the points that it keeps from load step to load step, its attributes.
            They are saved, gone back to, restarted, written and drawn by what is said here.
        name: What is modelled where, for results.

    Args:
        site: Where it acts.
    """

    kind: ClassVar[str] = ""
    model: ClassVar[str] = ""
    exact_model: ClassVar[str] = ""
    checks: tuple[str, ...] = ()
    state: tuple[PointArray, ...] = ()

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
        """Name of the law in messages."""
        return f"law '{self.kind}'"

    @property
    def has_vjp(self) -> bool:
        """Whether ``vjp`` goes back through all arrays that it keeps between load steps."""
        return not {array.name for array in self.state} - self.derived_state

    @property
    def derived_state(self) -> set[str]:
        """Names of arrays of ``state`` by which gradients go back to load steps before."""
        return {"reference", "bound"}

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


class ContactForce:
    """Forces at a contact that follow the jump; this one is 0, and others say what they are.

    Attributes:
        follows_jump: Whether there are any, so that it has forms.
        site: Where they act.
    """

    follows_jump: ClassVar[bool] = False
    site: LawSite

    @property
    def forms(self) -> tuple[CompiledForm, ...]:
        """Compiled forms of the forces that follow the jump; none where nothing does.

        They are compiled when they are first asked for.
        """
        return ()

    @property
    def tangents(self) -> tuple[CompiledForm, ...]:
        """Forms of the tangent at present."""
        return ()

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
        """Average over neighbouring points by which forces depend on their jumps, too; or None."""
        return None

    def tangent_between_points(self) -> Array:
        """Minus the derivative of its traction in the jump at other points; collective.

        Of each pair of ``neighbours``, beside ``tangent_at_points``, (pairs, components,
        components) (stress/length).
        """
        size = self.site.trace.normals.shape[1]
        return np.zeros((0, size, size))
