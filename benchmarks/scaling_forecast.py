"""What a run on more ranks than there are here would take, from measured constants.

Work of the volume is spread over ranks; reading the mesh, and factors at the contact, are not. A
rank is as fast as one of two here, whose neighbour works as well. What ranks say to each other over
a network is not in it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

Row = dict[str, Any]
Table = tuple[list[str], list[list[str]]]

# The factors of a surface's cells grow as those of a plane body: nested dissection takes n^(3/2).
_POWER_OF_FACTORS = 1.5
_RANKS = (1, 2, 8, 16, 64, 256, 1024)


@dataclass(frozen=True)
class _Part:
    """A part of a run.

    Attributes:
        name: In words.
        rate: Its constant in words, as measured.
        seconds: Of the foretold body on one rank.
        is_spread: Whether ranks share it.
    """

    name: str
    rate: str
    seconds: float
    is_spread: bool

    def on(self, ranks: int) -> float:
        return self.seconds / ranks if self.is_spread else self.seconds


class Forecast:
    """Seconds and memory of a larger run of the same scene.

    Args:
        rows: What was measured, of several sizes on one and on two ranks.
        cells: Of the larger body, along an edge.
        ranks: It would run on.
    """

    def __init__(self, rows: list[Row], cells: int, ranks: int) -> None:
        self._ranks = ranks
        self._dofs, self._cells = 3 * (2 * cells + 1) ** 3, cells**3
        ones = [row for row in rows if row["ranks"] == 1]
        twos = [row for row in rows if row["ranks"] == 2]
        self._cycles, self._growth = _extrapolated(ones, self._dofs)
        self._parts = self._parts_from(twos[-1], cells)
        self._memory = _slopes(twos)

    def _parts_from(self, row: Row, cells: int) -> list[_Part]:
        seconds, parts, calls = row["seconds"], row["parts"], row["calls"]
        ratio = self._dofs / row["dofs"]
        cycles = self._cycles / calls["V-cycles"]
        surface = (cells / row["cells"]) ** 2
        at_contact = ("factors at the contact", "solves at the contact")
        of_body = seconds["solve"] - sum(parts[name] for name in ("V-cycles", *at_contact))

        def spread(name: str, measured: float, times: float = 1.0, per: float = 1.0) -> _Part:
            rate = 1e6 * 2 * measured / per / row["dofs"]
            return _Part(name, f"{rate:.2g} µs a dof", 2 * measured * ratio * times, True)

        factors, solves = (parts[name] for name in at_contact)
        return [
            _Part(
                "mesh: Gmsh on one rank, and sent to the others",
                f"{1e6 * seconds['mesh'] / row['cells'] ** 3:.2g} µs a cell",
                seconds["mesh"] * self._cells / row["cells"] ** 3,
                False,
            ),
            spread("K", seconds["assemble"]),
            spread("multigrid's set-up", seconds["factorise"]),
            spread("V-cycles", parts["V-cycles"], cycles, calls["V-cycles"]),
            spread("rest of the solve (K times vectors, Krylov, forces)", of_body, cycles),
            _Part(
                "factors of the cells at the contact",
                f"{1e3 * factors / calls[at_contact[0]]:.2g} ms each here",
                factors * surface**_POWER_OF_FACTORS,
                False,
            ),
            _Part(
                "solves with them",
                f"{1e3 * solves / calls[at_contact[1]]:.2g} ms each here",
                solves * surface * cycles,
                False,
            ),
            spread("files", seconds["output"]),
        ]

    def table(self) -> Table:
        """Parts with their constants, and their seconds."""
        whole = sum(part.on(self._ranks) for part in self._parts)
        rows = [
            [
                part.name,
                part.rate,
                "yes" if part.is_spread else "no",
                f"{part.on(self._ranks):.3g} s",
                f"{part.on(self._ranks) / whole:.0%}",
            ]
            for part in self._parts
        ]
        first, others = self.memory(self._ranks)
        dofs = f"{self._dofs / 1e6:.1f} million unknowns on {self._ranks} ranks"
        rows.append([f"**together**, {self._cycles:.0f} V-cycles", "", "", f"{whole:.3g} s", ""])
        said = f"{first / 1e9:.2g} GB on the first rank, {others / 1e9:.2g} GB on each other"
        rows.append(["**memory**", "", "", said, ""])
        return ["part", "measured", "shared by ranks", dofs, "share"], rows

    def by_ranks(self) -> Table:
        """The same body on more and more ranks."""
        rows = []
        for ranks in _RANKS:
            seconds = [part.on(ranks) for part in self._parts]
            largest = max(self._parts, key=lambda part, on=ranks: part.on(on))  # type: ignore[misc]
            alone = sum(part.seconds for part in self._parts if not part.is_spread)
            first, others = self.memory(ranks)
            rows.append(
                [
                    str(ranks),
                    f"{sum(seconds):.3g} s",
                    f"{alone / sum(seconds):.0%}",
                    largest.name.split(":")[0],
                    f"{first / 1e9:.2g}, {others / 1e9:.2g} GB",
                ]
            )
        return (
            ["ranks", "seconds", "not shared by ranks", "largest part", "memory: first, others"],
            rows,
        )

    def memory(self, ranks: int) -> tuple[float, float]:
        """Bytes of the first rank and of each other."""
        base, of_dof, of_cell = self._memory
        share = base + of_dof * self._dofs / ranks
        return share + of_cell * self._cells, share


def _extrapolated(rows: list[Row], dofs: int) -> tuple[float, float]:
    """V-cycles of a larger body, and the power of the unknowns with which they grow (≥ 0)."""
    sizes = np.log([row["dofs"] for row in rows])
    cycles = np.log([row["calls"]["V-cycles"] for row in rows])
    growth = max(0.0, float(np.polyfit(sizes, cycles, 1)[0]))
    level = float(np.mean(cycles - growth * sizes))
    return float(np.exp(level + growth * np.log(dofs))), growth


def _slopes(rows: list[Row]) -> tuple[float, float, float]:
    """Bytes of a rank at no size, for each of its dofs; of the first for each cell of the whole."""
    own = np.array([row["dofs"] / row["ranks"] for row in rows])
    cells = np.array([row["cells"] ** 3 for row in rows])
    others = np.array([row["peak_bytes"][-1] for row in rows])
    first = np.array([row["peak_bytes"][0] for row in rows])
    of_dof, base = np.polyfit(own, others, 1)
    of_cell = max(0.0, float(cells @ (first - others) / (cells @ cells)))
    return float(base), float(of_dof), of_cell
