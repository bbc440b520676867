"""The scenes whose memory is measured, each with a solver and a number of ranks."""

from __future__ import annotations

from fenics_contact.verification.memory.blocks import (
    FLAT,
    HALF_SPACE,
    PAIRS,
    SMALL_FLAT_PAIR,
    Case,
    Seat,
    slab,
    square,
)

MemoryRun = tuple[Case | Seat, str, int]

# One body, a pair, full contact and contacts that share an edge, every solver: about a minute.
FEW: tuple[MemoryRun, ...] = (
    (square(90), "condensed", 1),
    (slab("P2 tets", 24), "condensed", 1),
    (FLAT[0], "condensed", 1),
    (FLAT[2], "iterative", 1),
    (Seat(10), "full", 1),
)
ALL: tuple[MemoryRun, ...] = (
    *FEW,
    (square(180), "condensed", 1),
    (slab("P1 tets", 32), "condensed", 1),
    (slab("P1 tets", 32), "condensed", 2),
    (slab("P2 tets", 32), "condensed", 1),
    (slab("Q2 hexes", 24), "condensed", 1),
    (FLAT[1], "condensed", 1),
    (PAIRS[1], "condensed", 1),
    (PAIRS[3], "condensed", 1),
    (PAIRS[3], "condensed", 2),
    (PAIRS[4], "condensed", 1),
    (SMALL_FLAT_PAIR, "condensed", 1),
    (Seat(10), "condensed", 1),
    (Seat(16), "condensed", 1),
    (square(90), "full", 1),
    (slab("P2 tets", 24), "full", 1),
    (FLAT[0], "full", 1),
    (PAIRS[4], "full", 1),
    (SMALL_FLAT_PAIR, "full", 1),
    (Seat(16), "full", 1),
    (slab("P1 tets", 32), "iterative", 1),
    (slab("P1 tets", 48), "iterative", 1),
    (slab("P1 tets", 48), "iterative", 2),
    (slab("P2 tets", 32), "iterative", 1),
    (HALF_SPACE, "iterative", 1),
    (FLAT[1], "iterative", 1),
    (Seat(10), "iterative", 1),
    (SMALL_FLAT_PAIR, "iterative", 1),
)
SCENES: dict[str, Case | Seat] = {case.name: case for case, _, _ in ALL}
