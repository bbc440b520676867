"""What two mesh files have in one place, which neither of them shows alone."""

from pathlib import Path

import pytest
from mpi4py import MPI

from fenics_contact import MeshSource
from fenics_contact.mesh.loading import load_body
from tests.messages import refused

COMM = MPI.COMM_WORLD


def strip(path, at=0.0, cells=3, length=3.0, named=()):
    """A strip of quadrilaterals from ``at`` on, 1 high, as CalculiX writes it."""
    xs = [at + length * number / cells for number in range(cells + 1)]
    nodes = [(x, y) for y in (0.0, 1.0) for x in xs]
    lines = ["*NODE", *(f"{n}, {x}, {y}" for n, (x, y) in enumerate(nodes, 1))]
    lines += ["*ELEMENT, TYPE=CPE4, ELSET=body"]
    for n in range(1, cells + 1):
        lines.append(f"{n}, {n}, {n + 1}, {cells + 2 + n}, {cells + 1 + n}")
    for name, element, side in named:
        lines += [f"*SURFACE, NAME={name}", f"{element}, S{side}"]
    if COMM.rank == 0:
        path.write_text("\n".join(lines) + "\n")
    return path


def loaded(folder, *strips):
    """The notes of strips as a body each."""
    sources = []
    for name, options in zip("ab", strips, strict=True):
        path = folder / f"{name}.inp"
        surface = [("top", 1, 3), *options.pop("named", ())]
        sources.append(MeshSource(str(strip(path, named=surface, **options)), name=name))
    COMM.Barrier()
    return " ".join(load_body(sources, 2, COMM).notes)


@pytest.fixture
def folder(tmp_path):
    return Path(COMM.bcast(str(tmp_path)))


def test_the_same_body_in_two_files_is_refused(folder):
    with refused("same_body_twice"):
        loaded(folder, {}, {})


def test_bodies_that_overlap_are_named(folder):
    said = loaded(folder, {}, {"cells": 4})
    assert "of 'a' lies in the element" in said and "of 'b', of another body" in said


def test_sides_that_meet_are_named_unless_a_surface_is(folder):
    """They are connected by nothing, and no contact can be there."""
    said = loaded(folder, {}, {"at": 3.0})
    assert "the element 3 of 'a' and the element 1 of 'b' lie against each other" in said
    assert loaded(folder, {}, {"at": 3.0, "named": [("left", 1, 4)]}) == ""
    assert loaded(folder, {}, {"at": 3.5}) == ""
