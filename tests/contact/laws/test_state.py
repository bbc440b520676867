"""What a law declares of its state is kept, restored and restarted by its name alone."""

import dataclasses

import numpy as np
from mpi4py import MPI

from fenics_contact import ContactPoints, Run
from fenics_contact.contact.laws import normal
from fenics_contact.contact.laws.normal.elastic_laws import Foundation
from fenics_contact.contact.state import ContactState
from fenics_contact.results.contact_points import AT_POINTS, WRITTEN, PointArray
from fenics_contact.simulation.state_file import StateFile
from fenics_contact.solve.load_steps.accepted_step import recall, remember
from tests.scenes import box_body
from tests.simulation.restart.test_state_file import STEPS, silent
from tests.solve.load_steps.histories import dragged

COMM = MPI.COMM_WORLD


class Worn(Foundation):
    """A foundation that also keeps how far it has worn, here by its depth in the last step."""

    state = (PointArray("wear", "length"), PointArray("grooves", "length", is_vector=True))

    def __init__(self, site):
        super().__init__(site)
        self.wear = np.zeros(len(site.trace.weights))
        self.grooves = np.zeros_like(site.trace.normals)

    def set_time(self, time):
        self.wear = time * self.site.trace.coordinates[:, 0]
        self.grooves = self.wear[:, None] * self.site.trace.normals


def worn_run(monkeypatch):
    monkeypatch.setattr(normal, "LAWS", (Worn,))
    scene = dragged(STEPS)
    contact = dataclasses.replace(
        scene.contact[0], penalty_parameter="auto", foundation_stiffness=1e4
    )
    return Run(dataclasses.replace(scene, contact=(contact,)), COMM, box_body((6, 3), (2, 1)))


def test_a_declared_array_is_remembered_and_recalled(monkeypatch):
    contact = worn_run(monkeypatch).problem.contacts[0]
    contact.normal.set_time(0.5)
    before = contact.normal.wear.copy(), contact.normal.grooves.copy()
    kept = remember(contact)
    contact.normal.set_time(1.0)
    recall(contact, kept)
    np.testing.assert_array_equal(contact.normal.wear, before[0])
    np.testing.assert_array_equal(contact.normal.grooves, before[1])


def test_a_declared_array_is_in_the_state_of_a_run(monkeypatch, folder):
    run = worn_run(monkeypatch)
    assert run.solve(StateFile(folder, run.problem), announce=silent).converged
    other = worn_run(monkeypatch).problem
    saved = StateFile(folder, other).load()
    recall(other.contacts[0], saved.last.contacts[0])
    law, x = other.contacts[0].normal, other.contacts[0].trace.coordinates[:, 0]
    np.testing.assert_allclose(law.wear, x, rtol=1e-12)  # as at the last step's time, 1
    np.testing.assert_allclose(law.grooves, x[:, None] * other.contacts[0].trace.normals)


def test_what_happens_at_the_points_is_one_list():
    names = {field.name for field in dataclasses.fields(ContactState)}
    assert names == {array.name for array in AT_POINTS} | {"status", "own"}
    assert {array.name for array in WRITTEN} < {
        field.name for field in dataclasses.fields(ContactPoints)
    }
