"""Numbers that are linear in the state of a body, as forces that do the same work on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem

from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.body.spaces import Spaces, of_owners, summed_over_ranks
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total


@dataclass(frozen=True, eq=False)
class ForcesOnState:
    """t with L = t · u + t_s · s + t_q · q.

    Attributes:
        nodal: On the displacement, (nodes, components).
        on_mean_stress: On the mean stress, at its dofs of this rank; empty without one.
        on_scalars: On the scalars q of the body's energy, (scalars,).
    """

    nodal: Array
    on_mean_stress: Array
    on_scalars: Array

    @classmethod
    def sum(cls, parts: Sequence[ForcesOnState]) -> ForcesOnState:
        """Sum of several, one at least."""
        return cls(
            np.sum([part.nodal for part in parts], axis=0),
            np.sum([part.on_mean_stress for part in parts], axis=0),
            np.sum([part.on_scalars for part in parts], axis=0),
        )


class TransposedForm:
    """A form that is linear in v and in the state of a body, seen from the state; collective.

    Args:
        form: In UFL, linear in the test function v and in the state.
        spaces: Those of the body.
        elastic: Its energy: scalars, and a mean stress where there is one.
        displacement: That of the state, in the form.
    """

    def __init__(
        self, form: ufl.Form, spaces: Spaces, elastic: ElasticBody, displacement: fem.Function
    ) -> None:
        self._spaces, self._elastic, self._displacement = spaces, elastic, displacement
        self._test = fem.Function(spaces.displacement_space)
        along = ufl.action(form, self._test)
        self._on_displacement = form_cache.form(ufl.derivative(along, displacement))
        self._on_mean_stress = self._value = None
        if elastic.mixed is not None:
            stress = elastic.mixed.mean_stress
            self._on_mean_stress = form_cache.form(ufl.derivative(along, stress))
        if elastic.scalar_forces:
            self._value = form_cache.form(along)

    def of(self, test: Array) -> ForcesOnState:
        """For one v; collective.

        Args:
            test: v at the nodes this rank owns, (nodes, components).
        """
        spaces = self._spaces
        index_map = spaces.displacement_space.dofmap.index_map
        self._test.x.array[:] = of_owners(index_map, test).reshape(-1)
        on_mean_stress = np.zeros(0)
        if self._on_mean_stress is not None:
            vector = fem.assemble_vector(self._on_mean_stress)
            on_mean_stress = summed_over_ranks(vector.index_map, np.array(vector.array))
        return ForcesOnState(
            spaces.assemble(self._on_displacement), on_mean_stress, self._of_scalars()
        )

    def _of_scalars(self) -> Array:
        """The form at a state of a unit of each scalar alone."""
        scalars = [one.present for one in self._elastic.scalar_forces]
        found = np.zeros(len(scalars))
        if self._value is None:
            return found
        mixed = self._elastic.mixed
        functions = [self._displacement] + ([] if mixed is None else [mixed.mean_stress])
        before = [function.x.array.copy() for function in functions]
        values_before = [float(scalar.value) for scalar in scalars]
        for function in functions:
            function.x.array[:] = 0.0
        for number in range(len(scalars)):
            for other, scalar in enumerate(scalars):
                scalar.value = 1.0 if other == number else 0.0
            found[number] = total(self._spaces.comm, fem.assemble_scalar(self._value))
        for function, values in zip(functions, before, strict=True):
            function.x.array[:] = values
        for scalar, value in zip(scalars, values_before, strict=True):
            scalar.value = value
        return found
