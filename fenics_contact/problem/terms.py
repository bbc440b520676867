"""The energy terms of a problem, by name, with the forms that are compiled for them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from dolfinx import fem

from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.problem.loads.given_load import GivenLoad
from fenics_contact.problem.scalars.scalar import ScalarUnknown


@dataclass(frozen=True, eq=False)
class Term:
    """One energy term: its name, and what compiles its forms where they are not yet."""

    name: str
    compiled: Callable[[], tuple[fem.Form, ...]] = tuple

    @property
    def forms(self) -> tuple[fem.Form, ...]:
        """The forms compiled for it; collective."""
        return self.compiled()

    @property
    def integrals(self) -> list[str]:
        """Kind of integral of each compiled form, such as ``exterior_facet``."""
        return [kind for form in self.forms for kind in compat.integral_types(form)]


def terms_of(
    elastic: ElasticBody,
    loads: Sequence[GivenLoad],
    unknowns: Sequence[ScalarUnknown],
    contacts: Sequence[ContactSurface],
) -> list[Term]:
    """One term for each thing the scene names, and no more.

    Args:
        elastic: The bulk.
        loads: Those that are not zero.
        unknowns: The scalar unknowns.
        contacts: In scene order.
    """
    terms = [Term(elastic.name, lambda: elastic.forms)]
    terms += [Term(load.name, partial(_form_of, load)) for load in loads]
    terms += _of_scalars(unknowns, None)
    for contact in contacts:
        law = contact.normal
        if law.loads_at_points:
            terms.append(Term(law.name, partial(_forms_of_loads, law)))
    for contact in contacts:
        terms += [Term(term.name, partial(getattr, term, "forms")) for term in contact.forces.terms]
        terms += _of_scalars(unknowns, contact)
    return terms


def _of_scalars(unknowns: Sequence[ScalarUnknown], contact: ContactSurface | None) -> list[Term]:
    """The terms of forces on scalar unknowns of a contact, or of none."""
    return [Term(one.term) for one in unknowns if one.term and one.contact is contact]


def _form_of(load: GivenLoad) -> tuple[fem.Form, ...]:
    return (load.form,)


def _forms_of_loads(law: NormalLaw) -> tuple[fem.Form, ...]:
    return tuple(form for form, _ in law.loads)
