"""What rows of scenes at random say: how far bars cover, what is wrong and passed; no FEniCSx."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from statistics import median
from typing import Any

import numpy as np

Row = Mapping[str, Any]

# Changes below this share of the size are round-off.
ROUND_OFF = 1e-9
# What is off by more bars than this, and by more of its size, is wrong.
BARS, SHARE = 3.0, 0.01
# Quantities below this share of the largest of their kind are nothing.
_NOTHING = 1e-6
_SIZES = {"force": "force", "area": "area", "energy": "energy", "work": "energy"}
_FORCES = ("force", "reaction", "vertical", "integral")
# Made of others, for comparison with what is known.
_DERIVED = ("vertical", "vertical_reaction")
# A change that comes back by this share oscillates; one that falls below this share converges.
_OSCILLATES, _CONVERGES = 0.25, 0.75
_ENDLESS = ("does not converge", "do not converge", "without bound", "infinite", "unbounded")


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
        cause: What may have made the bar too short.
        against: ``refined``, ``twin`` or ``known``.
        endless: Whether the run says that the quantity does not converge.
    """

    number: int
    kind: str
    name: str
    change: float
    bar: float | None
    size: float
    cause: str = ""
    against: str = "refined"
    endless: bool = False

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


@dataclass
class Coverage:
    """Of a quantity, over all scenes.

    Attributes:
        changes: How many count.
        covered: By the bar of the coarse answer.
        missing: Without a bar.
        endless: Left out: the run says that they do not converge.
        ratios: Bar over change.
    """

    changes: int = 0
    covered: int = 0
    missing: int = 0
    endless: int = 0
    ratios: list[float] = field(default_factory=list)

    def add(self, change: Change) -> None:
        """One more; without a bar it is not covered, unless it does not converge."""
        if change.bar is None and change.endless:
            self.endless += 1
            return
        self.changes += 1
        self.covered += change.covered
        self.missing += change.bar is None
        if change.bar is not None:
            self.ratios.append(change.bar / change.change)


def coverage(rows: Iterable[Row]) -> dict[str, Coverage]:
    """By quantity, of all scenes that were answered on both meshes, checks passed."""
    found: dict[str, Coverage] = {}
    for change in refinements(rows):
        found.setdefault(change.quantity, Coverage()).add(change)
    return found


def refinements(rows: Iterable[Row]) -> Iterator[Change]:
    """From each coarse answer to the fine one, where both passed all checks.

    What the finest mesh says, where there is one, tells a quantity that oscillates, and whether one
    that is said not to converge does.
    """
    by_key = {(row["number"], row["ranks"], row["stage"]): row for row in rows}
    for (number, ranks, stage), coarse in by_key.items():
        fine = by_key.get((number, ranks, "fine"))
        if stage == "coarse" and fine and coarse["code"] == fine["code"] == 0:
            finest = by_key.get((number, ranks, "finest"))
            for change in _changes(coarse, fine, "refined"):
                if finest and finest["code"] == 0 and change.name in finest["quantities"]:
                    change = _judged(change, coarse, fine, finest)
                yield change


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
        change.endless or (change.bar is not None and not change.covered)
        for change in refinements(rows)
    )


def _judged(change: Change, coarse: Row, fine: Row, finest: Row) -> Change:
    """With what the second change says of the first."""
    first, second, third = (
        np.array(row["quantities"][change.name][0]) for row in (coarse, fine, finest)
    )
    before, after = second - first, third - second
    lengths = np.linalg.norm(before), np.linalg.norm(after)
    causes = [change.cause] if change.cause else []
    if before @ after < 0 and lengths[1] > _OSCILLATES * lengths[0]:
        causes.append("oscillates with the mesh")
    endless = change.endless and lengths[1] > _CONVERGES * lengths[0]
    return replace(change, cause=", ".join(causes), endless=bool(endless))


def independent(rows: Iterable[Row]) -> Iterator[Change]:
    """From each answer to what statics, formulas or a twin give."""
    by_key = {(row["number"], row["ranks"], row["stage"]): row for row in rows}
    for (number, ranks, stage), coarse in by_key.items():
        if stage != "coarse" or coarse["code"] != 0:
            continue
        yield from _against_known(coarse)
        twin = by_key.get((number, ranks, "twin"))
        if twin and twin["code"] == 0:
            yield from _changes(coarse, twin, "twin", twin["factors"])


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
        size = _size(coarse, name, found, expected)
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
        cause = "contact's edge inside cells" if coarse.get("edge_inside") else ""
        yield Change(
            coarse["number"], coarse["kind"], name, change, bar, size, cause, against,
            _is_endless(coarse, name),
        )  # fmt: skip


def _size(coarse: Row, name: str, found: np.ndarray, expected: np.ndarray) -> float:
    """Of forces the largest in the scene; else its own, or next to nothing of its kind."""
    quantity = name.rsplit(".", 1)[-1]
    own = max(float(np.linalg.norm(found)), float(np.linalg.norm(expected)))
    sizes = coarse["sizes"]
    if quantity.endswith(_FORCES):
        return max(own, sizes["force"])
    kind = next((size for end, size in _SIZES.items() if quantity.endswith(end)), None)
    return max(own, _NOTHING * sizes[kind]) if kind else own


def _is_endless(coarse: Row, name: str) -> bool:
    """Whether a sentence says that this quantity does not converge."""
    quantity = name.rsplit(".", 1)[-1]
    words = (quantity, quantity.replace("_", " "))
    return any(
        any(word in note for word in words) and any(end in note for end in _ENDLESS)
        for note in coarse.get("notes", [])
    )


def against_statics(rows: Iterable[Row]) -> list[str]:
    """Scenes that were answered where statics refuse them, or the other way round."""
    found = []
    for row in rows:
        must = row.get("must_be", "")
        refused = row["code"] in (2, 3)
        if row["stage"] == "coarse" and (
            (must == "refused" and not refused) or (must == "answered" and refused)
        ):
            found.append(f"{_name(row)}: must be {must}, ended with {row['code']}: {row['words']}")
    return found


def rank_differences(rows: Iterable[Row]) -> list[str]:
    """Scenes whose outcome, or a number of it by more than 1e-6, depends on the number of ranks."""
    found, first = [], {}
    for row in rows:
        if row["stage"] != "coarse":
            continue
        other = first.setdefault(row["number"], row)
        if other is row:
            continue
        if other["code"] != row["code"]:
            codes = f"{other['code']} on {other['ranks']}, {row['code']} on {row['ranks']} ranks"
            found.append(f"{_name(row)}: {codes}")
        elif row["code"] == 0:
            found += [f"{_name(row)}: {text}" for text in _unlike(other, row)]
    return found


def _unlike(one: Row, other: Row, most: float = 1e-6) -> list[str]:
    """Quantities that differ."""
    found = []
    for name, (values, bar) in one["quantities"].items():
        theirs = other["quantities"].get(name, [[], None])
        a, b = np.array(values), np.array(theirs[0])
        if len(a) != len(b) or (bar is None) != (theirs[1] is None):
            found.append(f"{name} {values} ± {bar} and {theirs[0]} ± {theirs[1]}")
            continue
        change = float(np.linalg.norm(a - b))
        if change > most * _size(one, name, a, b):
            found.append(f"{name} {values} and {theirs[0]}")
    return found


def _name(row: Row) -> str:
    return f"{row['number']} ({row['kind']})"


def table(found: Mapping[str, Coverage]) -> str:
    """Of all quantities, as Markdown."""
    lines = [
        "| quantity | changes | covered | without a bar | do not converge | median bar / change |",
        "|---|---|---|---|---|---|",
    ]
    for name, each in sorted(found.items(), key=lambda item: -item[1].changes):
        share = f"{100 * each.covered / each.changes:.0f} %" if each.changes else ""
        ratio = f"{median(each.ratios):.2g}" if each.ratios else ""
        lines.append(
            f"| {name} | {each.changes} | {share} | {each.missing} | {each.endless} | {ratio} |"
        )
    return "\n".join(lines)
