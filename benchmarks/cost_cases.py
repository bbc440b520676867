"""Which blocks of cells are measured, by which solvers."""

from __future__ import annotations

from fenics_contact.verification.memory_check import (
    FLAT,
    FLAT_PAIRS,
    FURTHER,
    HALF_SPACE,
    PAIRS,
    SMALL_FLAT_PAIR,
    BlockCase,
    slab,
    square,
)


def quick_runs() -> list[tuple[BlockCase, str]]:
    """Cases, each with the name of a solver, that take about a minute in all."""
    return [
        (square(43), "condensed"),
        (square(43), "full"),
        (square(43, 1 + FURTHER), "condensed"),
        (square(90), "condensed"),
        (slab("P1 tets", 24), "condensed"),
        (PAIRS[0], "condensed"),
        (FLAT[1], "iterative"),
        (SMALL_FLAT_PAIR, "condensed"),
    ]


def all_runs() -> list[tuple[BlockCase, str]]:
    """Cases, each with the name of a solver."""
    solids = ("P1 tets", "P2 tets", "Q1 hexes", "Q2 hexes")
    condensed = [
        *(square(cells) for cells in (43, 90, 180)),
        *(slab(element, points) for element in solids for points in (24, 32, 40)),
        BlockCase("Q2 hexes", (12, 12, 6), all_of_top=True),
        square(43, 1 + FURTHER),
        square(90, 1 + FURTHER),
        slab("P2 tets", 32, 1 + FURTHER),
        *PAIRS,
        *FLAT[:2],
        SMALL_FLAT_PAIR,
        *FLAT_PAIRS[:2],
    ]
    # A factorisation a Newton step takes long: on the smallest meshes only.
    full = [square(43), slab("P2 tets", 24)]
    iterative = [
        *(slab(element, points) for element in ("P1 tets", "P2 tets") for points in (32, 48, 64)),
        slab("Q2 hexes", 48),
        HALF_SPACE,
        *FLAT,
        PAIRS[3],
        SMALL_FLAT_PAIR,
        *FLAT_PAIRS,
    ]
    return [
        *((case, "condensed") for case in condensed),
        *((case, "full") for case in full),
        *((case, "iterative") for case in iterative),
        *((case, "auto") for case in (*FLAT, *FLAT_PAIRS[:2], HALF_SPACE)),
    ]
