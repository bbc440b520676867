"""Scenes at random in other units, and of other thicknesses: what changes but for factors.

``python benchmarks/random_units.py [--number 100] [--first 0] [--seed 9] [--most 8]``

Solves each scene once more in each of six systems of units; plane ones, in plane stress, once more
for each of several thicknesses. Forces that are given follow the thickness, tractions do not. Says
which values, error bars and automatic parameters differ by more than a factor, and fails if any do.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.random.kinds import draw_any
from tests.random.outcomes import outcome_of
from tests.random.scaled import SYSTEMS, Factors, differences, plane_stress, scaled, smaller
from tests.random.scenes import RandomScene

THICKNESSES = (0.002, 0.0787, 20.0, 1000.0)


def parsed() -> argparse.Namespace:
    """What is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--number", type=int, default=100, help="of scenes")
    parser.add_argument("--first", type=int, default=0, help="number of the first one")
    parser.add_argument("--seed", type=int, default=9)
    parser.add_argument("--most", type=int, default=8, help="cells along an axis, in space 3")
    return parser.parse_args()


def main() -> int:
    """Solve, say what differs, and fail if something does."""
    options, failed = parsed(), 0
    for number in range(options.first, options.first + options.number):
        random = draw_any(options.seed, number)
        random = smaller(random, 3 if random.scene.dimension == 3 else options.most)
        found = list(unlike(random))
        failed += bool(found)
        print(f"{number} {random.kind} {random.scene.kinematics}: {len(found)} differ", flush=True)
        print("\n".join(f"    {line}" for line in found), end="\n" * bool(found), flush=True)
    print(f"{failed} of {options.number} scenes differ by more than factors")
    return int(failed > 0)


def unlike(random: RandomScene) -> Iterator[str]:
    """What differs of a scene, in words."""
    scene = random.scene
    cases = {system: Factors(*factors) for system, factors in SYSTEMS.items()}
    yield from _unlike(random, cases)
    if scene.dimension == 2 and scene.kinematics != "axisymmetric" and scene.half_space is None:
        yield from _unlike(
            plane_stress(random), {f"t = {t:g}": Factors(thickness=t) for t in THICKNESSES}
        )


def _unlike(random: RandomScene, cases: dict[str, Factors]) -> Iterator[str]:
    one = outcome_of(random)
    for name, factors in cases.items():
        other = outcome_of(scaled(random, factors))
        if one.result is None or other.result is None:
            if one.code != other.code:
                yield f"{name}: {one.words} and {other.words}"
            continue
        for text in differences(random.scene, one.result, other.result, factors):
            yield f"{name}: {text}"


if __name__ == "__main__":
    sys.exit(main())
