"""Answers on cells that are subdivided, exact where they must be."""

import re

import pytest
from mpi4py import MPI

from fenics_contact import Load, Material, Point, Scene, Support, load_scene, run
from tests.mesh.readers.mixed_blocks import MixedBlock
from tests.mesh.test_loading import write
from tests.scenes import ROOT

COMM = MPI.COMM_WORLD


@pytest.mark.parametrize("order", [1, 2])
def test_patch(folder, order):
    """A linear displacement is had exactly on each subdivision (patch test)."""
    block = MixedBlock(("hexahedra", "wedges", "pyramids"), order, along=2)
    scene = Scene(
        kinematics="3D",
        mesh=write(folder, block.inp(), "p.inp"),
        material=Material(1000.0, 0.0),
        support=(Support("n_bottom", {"x": 0, "y": 0, "z": 0}),),
        load=(Load("top", traction=(0, 0, -10)),),
        contact=(),
        point=(Point("corner", (2, 1, 1)), Point("inside", (0.6, 0.4, 0.7))),
    )
    found = run(scene, COMM)
    assert found.quantities["displacement_corner"] == pytest.approx([0, 0, -0.01], abs=1e-10)
    assert found.quantities["displacement_inside"] == pytest.approx([0, 0, -0.007], abs=1e-10)


def test_the_deck_of_the_page(folder):
    """The how-to's deck carries what equilibrium asks for."""
    text = (ROOT / "docs" / "howto" / "deck.md").read_text(encoding="utf-8")
    write(folder, re.search(r"```c\n(.*?)```", text, re.S)[1], "press.inp")
    scene = re.search(r"```toml\n(.*?)```", text, re.S)[1].replace(
        "press.inp", f"{folder}/press.inp"
    )
    write(folder, scene, "press.toml")
    found = run(load_scene(folder / "press.toml"), COMM)
    assert found.passed, found.verdict
    assert found.quantities["normal_force"] == pytest.approx(200, rel=1e-6)
