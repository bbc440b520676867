"""How often the intervals of a fit cover the truth, and how wide they are.

A rigid parabola is pressed on a block and dragged to and fro along it, with gross slip at both ends
of the loop. Data are the friction force of a run on a finer mesh, with 1 % noise; coefficient of
friction and Young's modulus are found from them on a coarser mesh, in each trial with other noise
and another start.

    ./bootstrap python benchmarks/fit_coverage.py [--quick] [--number N] [--json FILE]
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from fenics_contact import (
    Body,
    Contact,
    Discretisation,
    Material,
    Measured,
    Obstacle,
    Scene,
    SolverSettings,
    Steps,
    Study,
    Support,
    fit,
)
from fenics_contact import Path as LoadPath
from fenics_contact.verification.boxes import Box, boxes

FRICTION, MODULUS = "contact.0.friction_coefficient", "material.0.youngs_modulus"
TRUTH = {FRICTION: 0.3, MODULUS: 1000.0}
QUANTITY = "friction_force_x"
NOISE = 0.01  # of the largest force
STEPS = 16
FITTED, FINER = (16, 12), (48, 36)  # cells along and across
# Of all trials, and of those of --quick.
NUMBER, QUICK = 300, 12


@dataclass(frozen=True)
class Trial:
    """What came of one fit, of each parameter in the order of ``TRUTH``.

    Attributes:
        covered: Whether the interval holds the truth.
        widths: Of the interval over that of the noise alone.
        evaluations: How often the curve was solved for.
        converged: Whether the search came to its end.
    """

    covered: list[bool]
    widths: list[float]
    evaluations: int
    converged: bool


def scene_of(values: dict[str, float]) -> Scene:
    """The block under the parabola.

    Args:
        values: Of the parameters.
    """
    pressed = 1 / STEPS
    obstacle = Obstacle(
        "parabola",
        radius=1,
        position=(0.5, 1),
        force=8.0,
        displacement=(0.02, 0),
        path=LoadPath(time=(0, pressed, 1), factor=(0, 1, 1)),
        displacement_path=LoadPath(time=(0, pressed, 0.375, 1), factor=(0, 0, 1, -1)),
    )
    return Scene(
        kinematics="plane strain",
        material=Material(values[MODULUS], 0.3),
        discretisation=Discretisation(2),
        support=(Support("block.y0", {"x": 0, "y": 0}),),
        contact=(
            Contact(
                "block.y1",
                obstacle=obstacle,
                friction_coefficient=values[FRICTION],
                law="incremental",
            ),
        ),
        steps=Steps(number=STEPS),
        solver=SolverSettings(errors="none"),
    )


def block(cells: tuple[int, int]) -> Body:
    """The unit square.

    Args:
        cells: Along and across it.
    """
    return boxes((Box("block", (0, 0), (1, 1), cells),))


def true_curve(cells: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Times and forces of the run with the true values.

    Args:
        cells: Of its mesh.
    """
    study = Study(scene_of(TRUTH), body=block(cells))
    history = study.history([QUANTITY], [])
    study.close()
    times = np.array([step.load_factor for step in history.steps])
    return times, np.array([step.quantities["friction_force"][0] for step in history.steps])


def trial(random: np.random.Generator, times: np.ndarray, forces: np.ndarray) -> Trial:
    """One fit.

    Args:
        random: Of the noise and the start.
        times: Of the data.
        forces: Without noise.
    """
    size = NOISE * float(np.abs(forces).max())
    noisy = forces + size * random.normal(size=len(forces))
    # The first row is before the obstacle moves, and tells nothing.
    data = Measured(("time",), times[1:, None], QUANTITY, noisy[1:], np.full(len(times) - 1, size))
    start = {key: value * float(random.uniform(0.7, 1.4)) for key, value in TRUTH.items()}
    study = Study(scene_of(start), body=block(FITTED))
    record = fit(study, data, {FRICTION: (0.05, 2.0), MODULUS: None}).record
    study.close()
    found = [(record.parameters[key], truth) for key, truth in TRUTH.items()]
    ends = [(one.low, one.high, one.noise, truth) for one, truth in found]
    known = all(low is not None and high is not None for low, high, _, _ in ends)
    return Trial(
        [known and low <= truth <= high for low, high, _, truth in ends],
        [0.5 * (high - low) / noise if known else float("inf") for low, high, noise, _ in ends],
        record.evaluations,
        record.converged,
    )


def summary(trials: list[Trial]) -> dict[str, object]:
    """Of all trials.

    Args:
        trials: That were made.
    """
    evaluations = [one.evaluations for one in trials]
    return {
        "trials": len(trials),
        "converged": sum(one.converged for one in trials),
        "evaluations_mean": float(np.mean(evaluations)),
        "evaluations_most": max(evaluations),
        "coverage": {
            key: float(np.mean([one.covered[place] for one in trials]))
            for place, key in enumerate(TRUTH)
        },
        "width_over_noise": {
            key: float(np.mean([one.widths[place] for one in trials]))
            for place, key in enumerate(TRUTH)
        },
    }


def main() -> int:
    """Make the trials and print what came of them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--number", type=int, default=NUMBER, help=f"of trials ({NUMBER})")
    parser.add_argument("--quick", action="store_true", help=f"{QUICK} trials: about a minute")
    parser.add_argument("--seed", type=int, default=1, help="of noise and starts (1)")
    parser.add_argument("--json", type=Path, help="file for all trials and the summary")
    options = parser.parse_args()
    times, forces = true_curve(FINER)
    random, begun, trials = np.random.default_rng(options.seed), time.process_time(), []
    for number in range(QUICK if options.quick else options.number):
        one = trial(random, times, forces)
        trials.append(one)
        widths = ", ".join(f"{width:.3f}" for width in one.widths)
        print(number + 1, one.covered, widths, one.evaluations, file=sys.stderr, flush=True)
    found = summary(trials) | {"seconds": time.process_time() - begun}
    print(json.dumps(found, indent=2))
    if options.json is not None:
        rows = [asdict(one) for one in trials]
        options.json.write_text(json.dumps(found | {"rows": rows}), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
