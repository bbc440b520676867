"""A state file that is kept in the repository is gone on from."""

import dataclasses

import pytest
from mpi4py import MPI

from fenics_contact import InputError, Run, Steps, Wear, load_scene
from fenics_contact.simulation.restart.state_file import StateFile
from tests.scenes import ROOT
from tests.solve.load_steps.histories import require_same

COMM = MPI.COMM_WORLD
# Written by commit 339c70e7 after two load steps: two blocks with wear and slip dependent friction.
FOLDER = ROOT / "tests" / "data" / "state_of_today"
LONGER = Steps(times=(1, 1.5, 2))


def silent(number, step):
    """Nothing to be said of a step."""


def test_it_is_gone_on_from():
    scene = dataclasses.replace(load_scene(FOLDER / "scene.toml"), steps=LONGER)
    whole = Run(scene, COMM).solve(announce=silent)
    run = Run(scene, COMM)
    saved = StateFile(FOLDER, run.problem).load()
    assert saved is not None and len(saved.steps) == 2
    found = run.solve(saved=saved, announce=silent)
    assert len(found.steps) == 3 and whole.quantities["worn_volume"] > 0
    require_same(found, whole)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"friction_law": None}, "contact differ"),
        ({"interference": 0.0}, "contact differ"),
        ({"wear": Wear(2e-3, share=0.5)}, "contact differ"),
    ],
)
def test_it_is_refused_for_another_scene(change, words):
    scene = load_scene(FOLDER / "scene.toml")
    first, second = scene.contact
    changed = dataclasses.replace(
        scene, contact=(first, dataclasses.replace(second, **change)), steps=LONGER
    )
    with pytest.raises(InputError, match=words):
        StateFile(FOLDER, Run(changed, COMM).problem).load()
