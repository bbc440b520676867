"""Sweeps whose points are solved by this process, as starting others takes seconds."""

import csv
import json

import numpy as np
import pytest

from fenics_contact.scene.reading import SceneFile
from fenics_contact.simulation.sweeps import leader
from fenics_contact.simulation.sweeps.answers import Answers
from fenics_contact.simulation.sweeps.sweep import Sweep

SLAB = """\
title = "Slab"
kinematics = "plane stress"
[mesh]
file = "{mesh}"
cell = "quadrilateral"
parameters = {{ cells_along = 4 }}
[material]
youngs_modulus = 1000
poissons_ratio = 0.3
[[support]]
on = "bottom"
displacement = {{ y = 0 }}
[[support]]
on = "left"
displacement = {{ x = 0 }}
[[load]]
on = "right"
traction = [-300, 0]
[[contact]]
on = "top"
pressure = 300
friction_coefficient = 0.3
[solver]
errors = "none"
"""
MU = "contact.0.friction_coefficient"


class InlineProcess:
    """As ``WorkerProcess``."""

    def __init__(self, folder):
        self._answers = Answers(folder, lambda memory: None)
        self._found = None

    def give(self, scene, digest):
        self._found = self._answers.answer(scene, digest)[1]

    def hear(self):
        return self._found

    def close(self):
        self._answers.close()


@pytest.fixture
def inline(monkeypatch):
    monkeypatch.setattr(leader, "WorkerProcess", InlineProcess)
    monkeypatch.setattr(leader, "ready", lambda processes, seconds: list(processes))


def swept(path, vary, folder, overrides=(), jobs=1, **more):
    """A sweep that is solved, and the points that were solved for it."""
    sweep = Sweep(SceneFile(path), overrides, vary, folder, **more)
    solved = []
    sweep.solve(jobs, lambda number, done: solved.append(number), lambda: False)
    return sweep, solved


def rows_of(folder):
    with (folder / "sweep.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def summary_of(folder):
    return json.loads((folder / "sweep.json").read_text())


def states_of(folder):
    with np.load(folder / "states.npz", allow_pickle=False) as found:
        return dict(found)
