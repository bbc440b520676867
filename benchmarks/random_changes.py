"""How far answers to scenes at random move: to a finer mesh, to what is known; no FEniCSx."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

Row = Mapping[str, Any]

# Changes below this share of the size are round-off.
ROUND_OFF = 1e-9
# What is off by more bars than this, and by more of its size, is wrong.
BARS, SHARE = 3.0, 0.01
EDGES, SWINGS = "edges inside cells", "oscillates with the mesh"
# Quantities below this share of the largest of their kind are nothing.
_NOTHING = 1e-6
_SIZES = {"force": "force", "area": "area", "energy": "energy", "work": "energy", "slip": "slip"}
_FORCES = ("force", "reaction", "vertical", "integral")
# Motions of faces, and what has moments: beside the largest, where scenes have couplings.
_OF_COUPLINGS = {"displacement", "rotation", "contact_moment", "reaction_moment"}
# Made of others, for comparison with what is known.
_DERIVED = ("vertical", "vertical_reaction")
# A change that comes back by this share oscillates; one that falls below this share converges.
_OSCILLATES, _CONVERGES = 0.25, 0.75
# Edges of what touches or sticks lie inside cells where the areas move by this share.
_MOVED = 0.02
# Checks that fail where cells are too coarse for an answer.
_OF_CELLS = {"unseen_contact", "boundary_stress"}
# What a run says of quantities that no mesh brings to an end; of all, and of peaks that may be so.
_ENDLESS = ("does not converge", "do not converge")
_ALL_ENDLESS, _PERHAPS = "Only what loads alone decide", "grows with every refinement"


@dataclass(frozen=True)
class Change:
    """Of a quantity from a mesh to the finer one, or to what is known.

    Attributes:
        number: Of the scene.
        kind: Of the scene.
        name: Of the quantity, with that of its contact or support.
        change: Length of the difference.
        bar: Of the coarse answer; None where it has none.
        size: What a share of is 1 %.
        against: ``refined``, ``twin`` or ``known``.
        endless: Whether the quantity does not converge: ``yes`` if the run says so, ``perhaps`` if
            it says that this may be, unless a third mesh tells.
        causes: What may have made the bar too short.
    """

    number: int
    kind: str
    name: str
    change: float
    bar: float | None
    size: float
    against: str = "refined"
    endless: str = ""
    causes: tuple[str, ...] = ()

    @property
    def quantity(self) -> str:
        """Without the name of its contact or support."""
        return self.name.rsplit(".", 1)[-1]

    @property
    def covered(self) -> bool:
        """Whether the bar is as long."""
        return self.bar is not None and self.change <= self.bar

    @property
    def far(self) -> bool:
        """Whether it is off by more than 1 %."""
        return self.change > SHARE * self.size

    @property
    def wrong(self) -> bool:
        """Whether it is off by more than its bar can explain; what has no bar claims nothing."""
        return self.far and self.bar is not None and self.change > BARS * self.bar


def refinements(rows: Iterable[Row]) -> Iterator[Change]:
    """From each coarse answer to the fine one, where both passed all checks.

    What the finest mesh says, where there is one, tells a quantity that oscillates, and whether one
    that is said not to converge does.
    """
    by_key = {(row["number"], row["ranks"], row["stage"]): row for row in rows}
    for (number, ranks, stage), coarse in by_key.items():
        fine = _answered(by_key, number, ranks, "fine")
        if stage == "coarse" and fine and coarse["code"] == 0:
            finest = _answered(by_key, number, ranks, "finest")
            edges = _edges_matter(coarse, fine, finest)
            for change in _changes(coarse, fine, "refined"):
                # Which points touch, stick or slip decides these, however little an edge moves.
                of_edges = change.quantity.endswith(("area", "max_slip"))
                if edges or (of_edges and _edges_within(coarse, fine)):
                    change = replace(change, causes=(EDGES,))
                if finest and change.name in finest["quantities"]:
                    change = _judged(change, coarse, fine, finest)
                yield change


def refused_rightly(rows: Iterable[Row]) -> set[int]:
    """Numbers of scenes whose cells are too coarse, as their checks say: they are off their twins.

    Only checks of how fine cells are fail, and some quantity is off by more than 1 % against a
    twin that passed all checks. A twin counts for all numbers of ranks.
    """
    rows = list(rows)
    twins = {row["number"]: row for row in rows if row["stage"] == "twin" and row["code"] == 0}
    found = set()
    for row in rows:
        twin = twins.get(row["number"])
        if twin is None or row["stage"] != "coarse" or row["code"] != 4:
            continue
        failed = {name for name, share in row["checks"].items() if not share <= 1}
        changes = _changes(row, twin, "twin", twin["factors"])
        if failed <= _OF_CELLS and any(change.far for change in changes):
            found.add(row["number"])
    return found


def short_bars(changes: Iterable[Change]) -> list[Change]:
    """Those whose bars do not cover them, the shortest bar first."""
    short = [change for change in changes if change.bar is not None and not change.covered]
    return sorted(short, key=lambda change: (change.bar or 0.0) / change.change)


def wants_finest(rows: Iterable[Row]) -> bool:
    """Whether a third mesh tells more of a scene: a bar is too short, or said not to be possible.

    Not in space, where that mesh is large.

    Args:
        rows: Of the scene.
    """
    rows = list(rows)
    if any(row.get("kinematics") == "3D" for row in rows):
        return False
    return any(
        not change.covered and (change.endless or change.bar) for change in refinements(rows)
    )


def _edges_matter(coarse: Row, fine: Row, finest: Row | None) -> bool:
    """Whether edges lie inside cells, and are elsewhere on finer ones."""
    # The edge of a punch stays where it is, in whichever cell that is.
    moves = coarse.get("punch") or _edges_move(coarse, finest or fine)
    return _edges_within(coarse, fine) and bool(moves)


def _edges_within(coarse: Row, fine: Row) -> bool:
    """Whether edges lie inside cells, those of zones that coarse cells miss altogether as well."""
    return bool(coarse.get("edges") or fine.get("edges"))


def _edges_move(coarse: Row, fine: Row) -> bool:
    """Whether what touches, sticks or slips changes with the mesh, by a share of what touches."""
    names = [name for name in coarse["quantities"] if name.endswith("area")]
    areas = [(coarse["quantities"][name][0][0], fine["quantities"].get(name)) for name in names]
    moved = [abs(area - other[0][0]) for area, other in areas if other is not None]
    return max(moved, default=0.0) > _MOVED * coarse["sizes"]["area"]


def _judged(change: Change, coarse: Row, fine: Row, finest: Row) -> Change:
    """With what the second change says of the first."""
    first, second, third = (
        np.array(row["quantities"][change.name][0]) for row in (coarse, fine, finest)
    )
    before, after = second - first, third - second
    lengths = np.linalg.norm(before), np.linalg.norm(after)
    swings = before @ after < 0 and lengths[1] > _OSCILLATES * lengths[0]
    causes = (*change.causes, SWINGS) if swings else change.causes
    grows = lengths[1] > _CONVERGES * lengths[0]
    return replace(change, causes=causes, endless="yes" if change.endless and grows else "")


def independent(rows: Iterable[Row]) -> Iterator[Change]:
    """From each answer to what statics, formulas or a twin give."""
    by_key = {(row["number"], row["ranks"], row["stage"]): row for row in rows}
    for (number, ranks, stage), coarse in by_key.items():
        if stage != "coarse" or coarse["code"] != 0:
            continue
        fine, finest, twin = (
            _answered(by_key, number, ranks, stage) for stage in ("fine", "finest", "twin")
        )
        changes = list(_against_known(coarse))
        if twin:
            changes += _changes(coarse, twin, "twin", twin["factors"])
        causes = (EDGES,) if fine and _edges_matter(coarse, fine, finest) else ()
        yield from (replace(change, causes=causes) for change in changes)


def _answered(by_key: Mapping[Any, Row], number: int, ranks: int, stage: str) -> Row | None:
    """The row of a stage, where that has an answer that passed all checks."""
    row = by_key.get((number, ranks, stage))
    return row if row and row["code"] == 0 else None


def _changes(
    coarse: Row, other: Row, against: str, factors: Mapping[str, float] | None = None
) -> Iterator[Change]:
    """Of all quantities that both have, but for round-off."""
    for name, (values, bar) in coarse["quantities"].items():
        if name.rsplit(".", 1)[-1] in _DERIVED or name not in other["quantities"]:
            continue
        if factors is not None and name not in factors:
            continue
        found, expected = np.array(values), np.array(other["quantities"][name][0])
        expected = expected * (factors or {}).get(name, 1.0)
        size = size_of(coarse, name, found, expected)
        yield from _change(coarse, name, found, expected, bar, size, against)


def _against_known(coarse: Row) -> Iterator[Change]:
    """Of what statics or formulas give; where a contact is the only one it has no name."""
    quantities = coarse["quantities"]
    for name, value, least in coarse["known"]:
        key = name if name in quantities else name.rsplit(".", 1)[-1]
        if key not in quantities:
            continue
        values, bar = quantities[key]
        found, expected = np.array(values), np.atleast_1d(np.array(value, dtype=float))
        size = max(float(np.linalg.norm(expected)), least)
        yield from _change(coarse, name, found, expected, bar, size, "known")


def _change(coarse, name, found, expected, bar, size, against) -> Iterator[Change]:
    """One, unless it is round-off."""
    if len(found) != len(expected):
        return
    change = float(np.linalg.norm(found - expected))
    if change > ROUND_OFF * size:
        endless = _is_endless(coarse, name)
        who = (coarse["number"], coarse["kind"])
        yield Change(*who, name, change, bar, size, against, endless)


def size_of(coarse: Row, name: str, found: np.ndarray, expected: np.ndarray) -> float:
    """Of forces the largest in the scene; else its own, or next to nothing of its kind."""
    quantity = name.rsplit(".", 1)[-1]
    own = max(float(np.linalg.norm(found)), float(np.linalg.norm(expected)))
    sizes = coarse["sizes"]
    if sizes["force"]:
        sizes = {**sizes, "slip": sizes["energy"] / sizes["force"]}
    if quantity.endswith(_FORCES):
        return max(own, sizes["force"])
    kind_of_coupling = quantity.rsplit("_", 1)[-1] if quantity in _OF_COUPLINGS else ""
    if kind_of_coupling in sizes:
        return max(own, sizes[kind_of_coupling])
    kind = next((size for end, size in _SIZES.items() if quantity.endswith(end)), None)
    return max(own, _NOTHING * sizes.get(kind, 0.0)) if kind else own


def _is_endless(coarse: Row, name: str) -> str:
    """Whether a sentence says that this quantity does not converge: ``yes``, ``perhaps`` or no."""
    quantity = name.rsplit(".", 1)[-1]
    for note in coarse.get("notes", []):
        if note.startswith(_ALL_ENDLESS):
            return "yes"
        if quantity.replace("_", " ") in note and any(end in note for end in _ENDLESS):
            return "yes"
        if quantity == "max_contact_pressure" and _PERHAPS in note:
            return "perhaps"
    return ""
