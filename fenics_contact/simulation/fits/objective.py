"""A quantity as a function of numbers of the scene, with its gradient, as optimisers take it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.simulation.sweeps.rows import row_of_step

if TYPE_CHECKING:
    from fenics_contact.simulation.studies.study import Study


class Objective:
    """A quantity of a study's answers, and its exact derivatives; collective.

    Attributes:
        of: Name of the quantity.
        by: Keys of the numbers.
        evaluations: How many answers were asked for.

    Args:
        study: Whose answers.
        of: Name of the quantity.
        by: Keys of the numbers, in the order in which they are passed.
        changes: What else is not as in the scene.
    """

    def __init__(
        self, study: Study, of: str, by: Sequence[str], changes: Mapping[str, Any] | None = None
    ) -> None:
        self._study, self._changes = study, dict(changes or {})
        self.of, self.by = of, tuple(by)
        self.evaluations = 0

    def __call__(self, values: ArrayLike) -> tuple[float, Array]:
        """The quantity, and its gradient in the numbers; collective.

        Args:
            values: The numbers, in the order of ``by``.

        Raises:
            InputError: There are not as many numbers; or as of ``Study.derivatives``.
            NotConvergedError: There is no answer.
        """
        numbers = np.atleast_1d(np.asarray(values, dtype=np.float64))
        if numbers.shape != (len(self.by),):
            raise InputError(
                f"objective: {numbers.size} values were passed for {len(self.by)} numbers: "
                + ", ".join(self.by)
            )
        changes = self._changes | dict(zip(self.by, numbers.tolist(), strict=True))
        history = self._study.history([self.of], self.by, changes, is_whole=False)
        self.evaluations += 1
        found = row_of_step(history.steps[-1]).get(self.of)
        if found is None:
            raise InputError(f"objective: the answer has no {self.of}")
        return found, np.array([history.slopes[key][-1, 0] for key in self.by])
