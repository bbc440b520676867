"""The paper's inequalities for a given pressure: (1.9), Lemma 2.2, Theorem 2.3."""

import numpy as np
import pytest
from dolfinx import fem
from mpi4py import MPI

from fenics_contact import Run
from fenics_contact.common.parallel import total
from tests.scenes import slab
from tests.solve.matrices import product

COMM = MPI.COMM_WORLD
BOUND = 90 * 8  # ∫ g


class Forms:
    """a, f, j and j_ε of a solved slab, for displacements at the nodes."""

    def __init__(self, epsilon):
        prepared = Run(slab(600, epsilon=epsilon), COMM)
        assert prepared.solve().passed
        self.problem = prepared.problem
        self.answer = prepared.solution.displacement
        self.contact = self.problem.contacts[0]
        self._stiffness = fem.assemble_matrix(self.problem.elastic.stiffness)
        self._stiffness.scatter_reverse()
        self._energy = fem.form(self.contact.friction_term.compiled_forms.energy)

    def _work(self, force, v):
        owned = slice(0, self.problem.spaces.owned_nodes)
        return total(COMM, np.sum(force[owned] * v[owned]))

    def a(self, u, v):
        force = np.zeros_like(u)
        owned = product(self._stiffness, u.ravel())
        force.ravel()[: len(owned)] = owned
        return self._work(force, v)

    def f(self, v):
        return self._work(self.problem.load, v)

    def slip(self, v):
        kinematics, trace = self.contact.kinematics, self.contact.trace
        return kinematics.tangential(trace.at_points(kinematics.relative(v)))

    def j(self, v):
        """(1.7), without UFL."""
        return self.contact.trace.integral(90 * np.linalg.norm(self.slip(v), axis=1))

    def j_epsilon(self, v, epsilon=1e-6):
        """(2.7), as compiled."""
        self.contact.friction.regularisation.set(epsilon)
        self.contact.friction_term.compiled_forms.update()
        self.contact.kinematics.move(self.contact.kinematics.relative(v))
        return COMM.allreduce(fem.assemble_scalar(self._energy))

    def admissible(self):
        """Displacements that vanish where supports hold: near the answer, and far away."""
        answer = self.answer
        yield from (0 * answer, -answer, 2 * answer)
        x = self.problem.spaces.coordinates
        for number in range(6):
            wave = np.sin((1 + number) * x[:, :1] * [1, 0.7] + x[:, 1:2] + [0, number])
            wave.reshape(-1)[self.problem.constrained] = 0.0
            for size in (1e-5, 1e-2, 1.0):
                yield answer + size * wave


@pytest.fixture(scope="module")
def forms():
    return Forms(1e-6)


@pytest.mark.parametrize(("epsilon", "nearest"), [(1e-6, 0.9), (1e-2, 0.9), (1.0, 0.3)])
def test_regularised_friction_energy_is_below_by_half_epsilon_at_most(forms, epsilon, nearest):
    """0 ≤ j − j_ε ≤ (ε/2) ∫ g, sharper than Lemma 2.2; nearly reached where most slip."""
    bound = epsilon / 2 * BOUND
    shares = []
    for v in forms.admissible():
        difference = forms.j(v) - forms.j_epsilon(v, epsilon)
        round_off = 1e-12 * forms.j(v)
        assert -round_off <= difference <= bound + round_off
        shares.append(difference / bound)
    assert max(shares) > nearest


def least_excess(forms, u, epsilon):
    """Least a(u, v − u) + j(v) − j(u) − f(v − u) over some v, over the strain energy of u."""
    found = [
        forms.a(u, v - u) + forms.j(v) - forms.j(u) - forms.f(v - u) + epsilon / 2 * BOUND
        for v in forms.admissible()
    ]
    return min(found) / forms.a(u, u)


def test_answer_meets_the_variational_inequality(forms):
    """(1.9), but for (ε/2) ∫ g, that by which j_ε is below j; an answer 1 % off does not."""
    assert least_excess(forms, forms.answer, 1e-6) > -1e-9
    assert least_excess(forms, 1.01 * forms.answer, 1e-6) < -1e-3


def least_distance(forms, u):
    """Least I_ε(v) − I_ε(u) − ½ a(v − u, v − u) over some v, over the strain energy of u."""

    def energy(v):
        return 0.5 * forms.a(v, v) - forms.f(v) + forms.j_epsilon(v)

    found = [energy(v) - energy(u) - 0.5 * forms.a(v - u, v - u) for v in forms.admissible()]
    return min(found) / forms.a(u, u)


def test_answer_is_the_only_minimiser(forms):
    """I_ε(v) ≥ I_ε(u_ε) + ½ a(v − u_ε, v − u_ε) (Theorem 2.3); an answer 1 % off is none."""
    assert least_distance(forms, forms.answer) > -1e-9
    assert least_distance(forms, 1.01 * forms.answer) < -1e-3
