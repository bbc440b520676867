"""Parts that no cell joins have factors of their own, and share those that would be the same."""

import dataclasses
import itertools

import numpy as np
import pytest
from mpi4py import MPI
from scipy.sparse import block_diag, csr_matrix, diags, identity, kron

from fenics_contact import Contact, Load, Material, Obstacle, Scene, Study, Support, run
from fenics_contact.common import mumps
from fenics_contact.common.factors.local_factor import LocalFactor
from fenics_contact.solve.condensed.part_factors import KnownFactors, RankFactor
from fenics_contact.verification.boxes import block

COMM = MPI.COMM_WORLD
NAMES = ("low", "middle", "high")


def blocks_apart(cells=(3, 3, 3), moduli=(1000, 1000, 1000)):
    """Blocks that do not touch each other, each on a floor of its own, pressed and pulled."""
    bases = (0.0, 2.5, 7.3)
    return Scene(
        kinematics="plane strain",
        mesh=tuple(
            dataclasses.replace(block("lower", n, base=base, cells_across=2), name=name)
            for name, n, base in zip(NAMES, cells, bases, strict=True)
        ),
        material=tuple(Material(m, 0.3, on=n) for n, m in zip(NAMES, moduli, strict=True)),
        support=tuple(Support(f"{name}.left", {"x": 0}) for name in NAMES),
        load=tuple(Load(f"{name}.top", pressure=5) for name in NAMES),
        contact=tuple(
            Contact(
                f"{name}.bottom",
                friction_coefficient=0.3,
                obstacle=Obstacle("plane", position=(0, base)),
            )
            for name, base in zip(NAMES, bases, strict=True)
        ),
    )


class Parts:
    """What a factor asks of a stiffness, of given matrices at given places."""

    is_plane = True

    def __init__(self, matrices, shifts, shuffle=None):
        count = len(matrices[0].toarray())
        order = np.arange(count * len(matrices)) if shuffle is None else shuffle
        self.matrix = csr_matrix(block_diag(matrices))[order][:, order]
        line = np.arange(count) // 2 * 0.1
        x = np.concatenate([line + shift for shift in shifts])
        self._places = np.column_stack([x, x * 0, x * 0])[order]
        self._kinds = (np.arange(len(x)) % 2)[order]
        self.asked = 0

    def places(self):
        self.asked += 1
        return self._places, self._kinds


def chain(stiffness, nodes=6):
    """Springs in a row, two displacements a node, the first node on a spring of its own."""
    found = np.zeros((2 * nodes, 2 * nodes))
    for node, which in itertools.product(range(nodes - 1), range(2)):
        at = [2 * node + which, 2 * node + 2 + which]
        found[np.ix_(at, at)] += stiffness * np.array([[1, -1], [-1, 1]])
    found[:2, :2] += np.array([[stiffness, 0.2], [0.2, stiffness]])
    for node in range(nodes - 1):  # across, so that both displacements are of one part
        found[2 * node, 2 * node + 3] = found[2 * node + 3, 2 * node] = 0.1
    return csr_matrix(found)


def dense_schur(matrix, kept):
    whole = matrix.toarray()
    inside = np.setdiff1d(np.arange(len(whole)), kept)
    left = np.linalg.solve(whole[np.ix_(inside, inside)], whole[np.ix_(inside, kept)])
    return whole[np.ix_(kept, kept)] - whole[np.ix_(kept, inside)] @ left


@pytest.mark.parametrize(
    ("springs", "shifts", "made"),
    [
        ((3.0, 3.0), (0.0, 7.1), 1),  # equal, but for the place
        ((3.0, 3.0 + 1e-9), (0.0, 7.1), 2),
        ((3.0, 4.0, 3.0), (0.0, 1.0, 1.0), 2),
        ((3.0,), (0.0,), 1),
    ],
)
def test_equal_parts_are_factorised_once(springs, shifts, made):
    """S and solutions are those of dense algebra, in the order of the whole."""
    count = 12 * len(springs)
    shuffle = np.random.default_rng(2).permutation(count)
    stiffness = Parts([chain(k) for k in springs], shifts, shuffle)
    kept = np.sort(np.flatnonzero(shuffle % 12 >= 10))  # the last node of each
    held = np.zeros(count, dtype=bool)
    known = KnownFactors()
    factor = RankFactor(stiffness, held, kept, known)
    assert factor.error is None
    assert known.made == made
    assert factor.schur() == pytest.approx(dense_schur(stiffness.matrix, kept), abs=1e-12)
    right = np.random.default_rng(3).normal(size=count)
    inside = np.setdiff1d(np.arange(count), kept)
    expected = np.zeros(count)
    expected[inside] = np.linalg.solve(
        stiffness.matrix.toarray()[np.ix_(inside, inside)], right[inside]
    )
    assert factor.solve(right) == pytest.approx(expected, abs=1e-12)
    assert factor.times(right) == pytest.approx(stiffness.matrix @ right)
    known.destroy()


def test_what_is_held_or_kept_elsewhere_makes_another_part():
    """Equal springs, but one end held, or another node condensed onto."""
    stiffness = Parts([chain(3.0), chain(3.0), chain(3.0)], (0.0, 2.0, 5.0))
    held = np.zeros(36, dtype=bool)
    held[12] = True
    kept = np.array([10, 11, 22, 23, 32, 33])
    known = KnownFactors()
    factor = RankFactor(stiffness, held, kept, known)
    assert known.made == 3
    again = RankFactor(stiffness, held, kept, known)
    assert known.made == 3
    assert not again.is_new
    assert again.schur() == pytest.approx(factor.schur(), abs=0)
    known.destroy()


def test_another_material_of_one_body_leaves_the_others_as_they_are():
    """Only the part that changed is factorised; numbers are those of a run of its own."""
    study = Study(blocks_apart(moduli=(1000, 700, 500)), COMM)
    study.solve()
    made = study._body.factors.made
    result = study.solve({"material.1.youngs_modulus": 2000})
    assert study.factorisations == 2
    if COMM.size == 1:
        assert made == 3
        assert study._body.factors.made == 4
    alone = run(study.changed({"material.1.youngs_modulus": 2000}), COMM)
    for ours, theirs in zip(result.contacts, alone.contacts, strict=True):
        for name in ("normal_force", "friction_force", "max_slip"):
            assert ours.quantities[name] == pytest.approx(theirs.quantities[name], rel=1e-9)
    study.solve()
    if COMM.size == 1:
        assert study._body.factors.made == 5  # the body before is not kept
    study.close()


def test_equal_blocks_share_a_factor_and_give_what_a_block_alone_gives():
    """Three that are equal but for where they stand, or one on other cells."""
    study = Study(blocks_apart(), COMM)
    found = study.solve()
    if COMM.size == 1:
        assert study._body.factors.made == 1
    one, two, three = (each.quantities for each in found.contacts)
    assert two["normal_force"] == pytest.approx(one["normal_force"], rel=1e-10)
    assert three["max_slip"] == pytest.approx(one["max_slip"], rel=1e-9)
    assert one["normal_force"] == pytest.approx(5.0, rel=1e-9)
    study.close()
    other = Study(blocks_apart(cells=(3, 4, 3)), COMM)
    other.solve()
    if COMM.size == 1:
        assert other._body.factors.made == 2
    other.close()


@pytest.mark.parametrize("count", [1, 2])
def test_several_right_hand_sides_are_solved_as_one_by_one(count):
    """By parts that share a factor, of which each keeps some unknowns."""
    rng = np.random.default_rng(2)
    matrix = csr_matrix(np.diag(np.full(12, 8.0)) + np.eye(12, k=2) + np.eye(12, k=-2))
    parts = Parts([matrix] * count, [0.0, 3.0][:count])
    size = 12 * count
    factor = RankFactor(parts, np.zeros(size, dtype=bool), np.arange(0, size, 5), None)
    right = rng.standard_normal((3, size))
    together = factor.solve(right)
    assert together == pytest.approx(np.array([factor.solve(one) for one in right]), rel=1e-13)
    left = right - factor.times(together)
    inside = np.delete(np.arange(size), np.arange(0, size, 5))
    assert np.abs(left[:, inside]).max() < 1e-12
    assert factor.solve(np.zeros((0, size))).shape == (0, size)
    factor.destroy()


def test_a_workspace_that_is_too_small_is_made_larger(monkeypatch):
    """As of a mean stress, where the units decide by how much more is taken than foreseen."""
    laplacian = csr_matrix(diags([-1.0, 2.1, -1.0], [-1, 0, 1], shape=(40, 40)))
    stiffness = csr_matrix(kron(laplacian, identity(40)) + kron(identity(40), laplacian))
    chosen, kept = mumps.fastest(True, stiffness.shape[0]), np.arange(3)
    expected = LocalFactor(stiffness, kept, chosen)
    tried = []

    def failure(factor):
        tried.append(factor.getMumpsIcntl(14))
        return plain(factor)

    plain = mumps.failure
    monkeypatch.setattr(mumps, "failure", failure)
    monkeypatch.setattr(mumps, "SPARE_WORKSPACE", (-90, 50))
    found = LocalFactor(stiffness, kept, chosen)
    assert found.error is None
    assert tried == [-90, 50]
    np.testing.assert_allclose(found.schur, expected.schur)
