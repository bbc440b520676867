"""The rows that a condensed body keeps: those of what scenes give, and groups of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.solve.condensed.schur import (
    Functional,
    GivenState,
    Key,
    Row,
    RowMaker,
    RowStack,
    Wanted,
)

# Round-off of a combination of what is given, of its size.
_SAME = 1e-13
_MOST_GIVEN = 24


class RowGroup:
    """Rows that are asked for together.

    Attributes:
        made: The rows by what they are of.
        is_portable: Whether these keys mean the same on any number of ranks.

    Args:
        maker: Makes them.
        is_portable: See the attributes.
    """

    def __init__(self, maker: RowMaker, is_portable: bool = True) -> None:
        self._maker, self.is_portable = maker, is_portable
        self.made: dict[Key, Row] = {}
        self._stack: RowStack | None = None

    def values(self, wanted: Wanted, state: GivenState) -> dict[Key, float]:
        """Numbers of the rows that are wanted; others are forgotten; collective.

        Args:
            wanted: What of → gives the functional, collective.
            state: Of the answer.
        """
        if self.made.keys() != wanted.keys() or self._stack is None:
            missing = [key for key in wanted if key not in self.made]
            rows = self._maker.make([wanted[key]() for key in missing])
            every = self.made | dict(zip(missing, rows, strict=True))
            self.made = {key: every[key] for key in wanted}
            self._stack = RowStack(self._maker, list(self.made.values()))
        return dict(zip(self.made, self._stack.values(state).tolist(), strict=True))


class GivenRows:
    """Rows of what a scene gives, loads and displacements of supports; collective.

    Those of a path, or of a value that is changed, are combinations of a few.

    Attributes:
        forgotten: How often all rows were forgotten, so that earlier shares say nothing any more.

    Args:
        maker: Makes them.
    """

    def __init__(self, maker: RowMaker) -> None:
        self._maker = maker
        self.forgotten = 0
        self._known: list[tuple[Functional, Row]] = []
        self._stack: RowStack | None = None
        self._last: list[tuple[Functional, Array]] = []

    @property
    def made(self) -> list[tuple[Functional, Row]]:
        """Functionals and rows that are kept."""
        return self._known

    def know(self, of: Functional, row: Row) -> None:
        """Take over a row that was made before."""
        self._known = [*self._known, (of, row)]
        self._stack = None

    def shares(self, wanted: Sequence[Functional]) -> Array:
        """Parts of the kept rows in those of functionals, (functionals, rows); collective.

        Args:
            wanted: With forces alone, or held displacements alone.
        """
        if len(self._known) + len(wanted) > _MOST_GIVEN:
            self._known, self._stack, self._last = [], None, []
            self.forgotten += 1
        found = []
        for number, of in enumerate(wanted):
            shares = self._last_shares(number, of)
            if shares is None:
                shares = self._combination(of)
            if shares is None:
                self.know(of, *self._maker.make([of]))
                shares = np.zeros(len(self._known))
                shares[-1] = 1.0
            found.append(shares)
        self._last = list(zip(wanted, found, strict=True))
        whole = np.zeros((len(wanted), len(self._known)))
        for number, shares in enumerate(found):
            whole[number, : len(shares)] = shares
        return whole

    def precompute(self, wanted: Sequence[Functional]) -> None:
        """Make the rows of functionals that are going to be asked for, together; collective.

        Args:
            wanted: Likewise.
        """
        if len(self._known) + len(wanted) <= _MOST_GIVEN:
            for of, row in zip(wanted, self._maker.make(wanted), strict=True):
                self.know(of, row)

    def values(self, shares: Array, state: GivenState) -> Array:
        """Values of functionals in a state, (functionals,); collective.

        Args:
            shares: As ``shares`` gave them; none were forgotten since.
            state: Of an answer.
        """
        return np.asarray(shares @ self._stacked.values(state)[: shares.shape[1]])

    @property
    def _stacked(self) -> RowStack:
        if self._stack is None:
            self._stack = RowStack(self._maker, [row for _, row in self._known])
        return self._stack

    def of_contacts(self, shares: Array) -> Array:
        """K v + t of functionals at the free contact dofs, (functionals, dofs).

        Of forces alone it is what they do to these dofs, of held displacements the opposite.

        Args:
            shares: As of ``values``.
        """
        return np.asarray(shares @ self._stacked.of_contacts[: shares.shape[1]])

    def _last_shares(self, number: int, of: Functional) -> Array | None:
        """Value of a functional that was asked for last in the same place; collective."""
        same, shares = False, None
        if number < len(self._last):
            last, shares = self._last[number]
            same = all(
                one is other or (one is not None and other is not None and (one == other).all())
                for one, other in ((of.forces, last.forces), (of.held, last.held))
            )
        is_same = bool(self._maker.stiffness.comm.allreduce(same, op=MPI.LAND))
        return shares if is_same else None

    def _combination(self, of: Functional) -> Array | None:
        """Shares of the known rows in a functional's, None if it is another one; collective."""
        comm, shares = self._maker.stiffness.comm, np.zeros(len(self._known))
        kind = "forces" if of.held is None else "held"
        wanted = getattr(of, kind)
        alike = [i for i, (known, _) in enumerate(self._known) if getattr(known, kind) is not None]
        acting = np.flatnonzero(wanted)
        columns = np.array([getattr(self._known[i][0], kind)[acting] for i in alike])
        columns = columns.reshape(len(alike), len(acting))
        outside = [np.abs(getattr(self._known[i][0], kind)).sum() for i in alike]
        sums = np.vstack([columns @ columns.T, columns @ wanted[acting]]).ravel()
        inside = np.abs(columns).sum(axis=1)
        size = float(np.abs(wanted[acting]).sum())
        sums = total(comm, np.concatenate([sums, outside, inside, [size]]))
        if sums[-1] == 0:
            return shares
        count = len(alike)
        outside, inside = sums[-1 - 2 * count : -1 - count], sums[-1 - count : -1]
        gram, right = np.split(sums[: count * (count + 1)].reshape(count + 1, count), [count])
        # None that is zero, and none that acts elsewhere, too.
        usable = (gram.diagonal() > 0) & (inside >= outside * (1 - _SAME))
        lengths = np.where(usable, np.sqrt(gram.diagonal()), np.inf)
        scaled = np.linalg.lstsq(
            gram / np.outer(lengths, lengths), right[0] / lengths, rcond=1e-14
        )[0]
        parts = scaled / lengths
        left = float(total(comm, np.abs(wanted[acting] - parts @ columns).sum()))
        if left > _SAME * sums[-1]:
            return None
        shares[alike] = parts
        return shares


_T = TypeVar("_T")


class BodyRows:
    """Rows by name, each made when an answer asks for it first; collective.

    Attributes:
        maker: Makes them.
        given: Those of what scenes give.

    Args:
        maker: Makes them.
    """

    def __init__(self, maker: RowMaker) -> None:
        self.maker, self.given = maker, GivenRows(maker)
        self._groups: dict[str, RowGroup] = {}
        self._found: dict[str, Any] = {}

    def group(self, name: str, is_portable: bool = True) -> RowGroup:
        """The rows of a name, kept.

        Args:
            name: Of the rows.
            is_portable: Whether their keys mean the same on any number of ranks.
        """
        return self._groups.setdefault(name, RowGroup(self.maker, is_portable))

    def once(self, name: str, make: Callable[[], _T]) -> _T:
        """Rows of this body with what is worked out for them, once."""
        if name not in self._found:
            self._found[name] = make()
        kept: _T = self._found[name]
        return kept

    @property
    def groups(self) -> Mapping[str, RowGroup]:
        """All rows that are kept, by name, but those of what is given."""
        return self._groups
