"""What laws of users across a contact are derived from."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol, cast

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.normal.energy_law import EnergyLaw
from fenics_contact.contact.laws.normal.law import Parameter
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.scene.contact import Contact


class _HasParameters(Protocol):
    parameters: Mapping[str, float]


class UserContactEnergy(EnergyLaw):
    """A law of your own: an energy density of depth and jump, with the scene's parameters.

    A class derived from it says ``density`` in UFL. Forces and tangents are its derivatives, and
    so are pressures, checks, error bars and derivatives of quantities.

    Attributes:
        model: What it models, in words, for results.

    Args:
        site: Where it acts; the program makes it.

    >>> from fenics_contact.contact.laws.normal.spring import positive
    >>> class Springs(UserContactEnergy):
    ...     @staticmethod
    ...     def density(depth, jump, k):
    ...         return k * positive(depth) ** 2 / 2
    """

    model = "own law"

    @classmethod
    def parameters(cls, contact: Contact) -> dict[str, Parameter]:
        """Parameters in the scene's table.

        Args:
            contact: Of the scene.

        Returns:
            Name → number, in the scene's units.
        """
        return dict(given_parameters(contact))

    def fields(self) -> Mapping[str, Array]:
        """The parameters, the same at all points."""
        return parameters_at_points(self.site)


def given_parameters(contact: Contact) -> Mapping[str, float]:
    """Parameters in the scene's table of a law across a contact, by name.

    Args:
        contact: Of the scene; its law has parameters.
    """
    return cast(_HasParameters, contact.normal_law).parameters


def parameters_at_points(site: LawSite) -> dict[str, Array]:
    """Parameters in the scene's table at all points of a contact, by name, (points,) each.

    Args:
        site: Where the law acts.
    """
    count = len(site.trace.weights)
    return {name: np.full(count, value) for name, value in given_parameters(site.contact).items()}
