"""Contacts across the cut of a sector against those of the whole ring, of which it is a copy."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Path, Run, Steps, Study, Support
from fenics_contact.trust.convergence.displacement_jumps import displacement_jumps
from tests.problem.sectors import (
    SECTORS,
    blocks_on_disc,
    fitted,
    hub_on_shaft,
    on_disc,
    sector,
    teeth_on_disc,
)

COMM = MPI.COMM_WORLD
SUMS = ("contact_area", "strain_energy", "external_work")


def off_at_points(whole, part, name, number=0):
    """Largest difference of an array at a contact's points from the same points of the whole."""
    values, places = [], []
    for result in (whole, part):
        mine = np.asarray(result.points.contact) == number
        places.append(result.points.coordinates[mine])
        values.append(getattr(result.points, name)[mine])
    apart = np.linalg.norm(places[1][:, None] - places[0], axis=2)
    assert apart.min(axis=1).max() < 1e-9
    same = values[0][apart.argmin(axis=1)]
    return np.abs(values[1] - same).max() / np.abs(values[0]).max()


@pytest.mark.parametrize(
    ("scene", "mesh"),
    [
        ({}, {"offset": 0.4}),
        ({"solver": "full", "slave": "against", "law": "incremental"}, {"offset": 1.7}),
        ({}, {"cells": ((2, 2), (3, 2)), "order": 2, "offset": -0.3}),
    ],
)
def test_a_hub_that_is_cut_elsewhere_than_its_shaft(scene, mesh):
    """Points of the slave face the master of the next sector, or of the one after it."""
    whole = Run(fitted(True, **scene), COMM, hub_on_shaft(SECTORS, **mesh)).solve()
    run = sector(mesh, **scene)
    part = run.solve()
    assert run.problem.contacts[0].sides.pairing.crosses_cut
    assert part.passed, part.verdict
    assert off_at_points(whole, part, "contact_pressure") < 1e-8
    assert off_at_points(whole, part, "friction_traction") < 1e-8
    for name in (*SUMS, "pressure_integral"):
        value = part.cyclic_symmetry.whole[name]
        assert value == pytest.approx(whole.quantities[name], rel=1e-8)


def test_a_hub_in_space_that_is_cut_elsewhere():
    """The whole repeats itself to 1e-7: parts that facets share are cut along one direction."""
    mesh, scene = {"dimension": 3, "cells": ((1, 1), (2, 1)), "offset": 0.3}, {"dimension": 3}
    whole = Run(fitted(True, **scene), COMM, hub_on_shaft(SECTORS, **mesh)).solve()
    part = sector(mesh, **scene).solve()
    assert part.passed, part.verdict
    for name in ("contact_pressure", "friction_traction"):
        assert off_at_points(whole, part, name) < 1e-6


@pytest.mark.parametrize(
    "scene", [{"slave": "on"}, {"slave": "against", "solver": "full", "law": "incremental"}]
)
def test_teeth_that_touch_those_of_the_sectors_beside(scene):
    """A side of each tooth faces the other side of itself, turned: that of the next tooth."""
    whole = Run(on_disc(True, "teeth", **scene), COMM, teeth_on_disc(SECTORS)).solve()
    part = Run(on_disc(False, "teeth", **scene), COMM, teeth_on_disc(1)).solve()
    assert part.passed, part.verdict
    assert off_at_points(whole, part, "contact_pressure", 1) < 1e-7
    assert off_at_points(whole, part, "friction_traction", 1) < 1e-7
    assert part.contacts[1].quantities["contact_area"] > 5
    for name in SUMS:
        value = part.cyclic_symmetry.whole[name]
        assert value == pytest.approx(whole.quantities[name], rel=1e-8)


@pytest.mark.parametrize("scene", [{"slave": "on"}, {"slave": "against", "solver": "full"}])
def test_a_block_that_the_cut_parts(scene):
    """One piece of it begins the sector, another one ends it: each goes on in the other."""
    whole = Run(on_disc(True, "blocks", **scene), COMM, blocks_on_disc(SECTORS)).solve()
    part = Run(on_disc(False, "blocks", **scene), COMM, blocks_on_disc(1)).solve()
    assert part.passed, part.verdict
    assert off_at_points(whole, part, "contact_pressure") < 1e-8
    assert off_at_points(whole, part, "friction_traction") < 1e-8


def test_pieces_of_a_block_whose_meshes_do_not_match():
    """As pieces that match, but for what other cells change."""
    energies = []
    for layers in ((3, 3), (4, 3)):
        part = Run(on_disc(False, "blocks", slave="against"), COMM, blocks_on_disc(1, layers))
        result = part.solve()
        assert result.passed, result.verdict
        energies.append(result.quantities["strain_energy"])
    assert energies[1] == pytest.approx(energies[0], rel=2e-2)


def test_a_block_that_slides_across_the_cut_over_load_steps():
    """What faces what is found again after each step; pressed first, then pushed."""
    found = []
    for whole in (True, False):
        scene = on_disc(whole, "blocks", law="incremental", friction_coefficient=0.1)
        pressed, pushed = scene.load
        steps = dataclasses.replace(pushed, path=Path(time=(0, 0.5, 1), factor=(0, 0, 1)))
        scene = dataclasses.replace(scene, load=(pressed, steps), steps=Steps(4))
        found.append(Run(scene, COMM, blocks_on_disc(SECTORS if whole else 1)).solve())
    assert found[1].converged
    for name in ("contact_pressure", "friction_traction", "slip"):
        assert off_at_points(*found, name) < 1e-7


def test_derivatives_across_the_cut():
    """Of the interference and friction, against central differences."""
    of, keys = ("strain_energy", "pressure_integral"), ("contact.0.interference",)
    study = Study(fitted(False, twist=0.0), body=hub_on_shaft(1, offset=0.4))
    slopes = study.derivatives(of, by=keys)
    step = 1e-5
    ends = [study.solve({keys[0]: 0.02 + sign * step}).quantities for sign in (1, -1)]
    for name in of:
        expected = (ends[0][name] - ends[1][name]) / (2 * step)
        assert slopes[name][keys[0]] == pytest.approx(expected, rel=1e-4)


def test_supports_of_neighbours_that_push_them_together():
    """Rims of teeth are moved along x of each: the body tears where two of them meet."""
    sizes = []
    for whole in (True, False):
        copies, scene = SECTORS if whole else 1, on_disc(whole, "teeth")
        turns = 2 * np.pi * np.arange(copies) / SECTORS
        rims = tuple(
            Support(f"tooth{k}.y1", {"x": -0.02 * np.cos(turn), "y": -0.02 * np.sin(turn)})
            for k, turn in enumerate(turns)
        )
        scene = dataclasses.replace(scene, support=(*scene.support, *rims), load=())
        run = Run(scene, COMM, teeth_on_disc(copies))
        run.solve()
        moved = run.problem.displacement.x.array.reshape(-1, 2)
        sizes.append([jump.size for jump in displacement_jumps(run.problem, moved, 1.0)])
    assert max(sizes[1]) == pytest.approx(max(sizes[0]))
