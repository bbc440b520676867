"""Contact problems from arrays, and the laws written down once more to judge their answers."""

import numpy as np

from fenics_contact.analytic.half_space import boussinesq, cerruti, flamant, flamant_along
from fenics_contact.common.arrays import Array
from fenics_contact.solve.exact import ExactAnswer, LocalProblem, PointLaws

YOUNGS_MODULUS, POISSONS_RATIO = 1000.0, 0.3
INWARD, ALONG, ASIDE = np.array([0.0, 0.0, -1.0]), np.array([1.0, 0, 0]), np.array([0, 1.0, 0])


def half_plane(points: int) -> tuple[Array, Array]:
    """W of a half-plane under uniform tractions on cells of a width 1, and the cells' centres."""
    width = 1 / points
    places = (np.arange(points) + 0.5) * width - 0.5
    compliance = np.zeros((2 * points, 2 * points))
    for place, weight in zip(*np.polynomial.legendre.leggauss(6), strict=True):
        away = (places[:, None] - places - place * width / 2).ravel()
        vectors = away[:, None] * ALONG
        of_body = (INWARD, YOUNGS_MODULUS, POISSONS_RATIO, 3.0)
        moved = (flamant(vectors, *of_body), flamant_along(vectors, ALONG, *of_body))
        for column, displacement in enumerate(moved):
            for row, way in enumerate((INWARD, ALONG)):
                part = weight / 2 * (displacement @ way).reshape(points, points)
                compliance[row::2, column::2] += part
    return compliance, places


def half_space(points: int) -> tuple[Array, Array]:
    """W of a half-space under uniform tractions on squares of a square of width 1; centres."""
    width = 1 / points
    line = (np.arange(points) + 0.5) * width - 0.5
    places = np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1).reshape(-1, 2)
    count = len(places)
    compliance = np.zeros((3 * count, 3 * count))
    gauss = list(zip(*np.polynomial.legendre.leggauss(4), strict=True))
    of_body = (INWARD, YOUNGS_MODULUS, POISSONS_RATIO)
    for x, wx in gauss:
        for y, wy in gauss:
            away = places[:, None] - places - np.array([x, y]) * width / 2
            vectors = np.concatenate([away.reshape(-1, 2), np.zeros((count**2, 1))], axis=1)
            moved = (
                boussinesq(vectors, *of_body),
                cerruti(vectors, ALONG, *of_body),
                cerruti(vectors, ASIDE, *of_body),
            )
            for column, displacement in enumerate(moved):
                for row, way in enumerate((INWARD, ALONG, ASIDE)):
                    part = wx * wy / 4 * (displacement @ way).reshape(count, count)
                    compliance[row::3, column::3] += part
    return compliance, places


def pressed(
    compliance: Array, places: Array, depth: float, aside: float | Array, laws: PointLaws
) -> LocalProblem:
    """A paraboloid of the radius 1, pressed into a half-space and moved along it."""
    size = len(compliance) // laws.number
    free = np.zeros((laws.number, size))
    squares = places**2 if places.ndim == 1 else (places**2).sum(axis=1)
    free[:, 0] = squares / 2 - depth
    free[:, 1:] = -np.asarray(aside)
    return LocalProblem(compliance, free.ravel(), laws)


def one_point(coefficient: float) -> LocalProblem:
    """K = [[2, 1], [1, 1]] under F = (.5, .6), into the obstacle and along it."""
    compliance = np.linalg.inv([[2.0, 1.0], [1.0, 1.0]])
    # The force .5 into the obstacle closes the gap, so that the gap without forces is negative.
    return LocalProblem(compliance, -compliance @ [0.5, 0.6], PointLaws(np.array([coefficient])))


def violation(answer: ExactAnswer) -> float:
    """Largest violation of the laws, over the largest force and gap, by the laws written out."""
    problem, laws = answer.problem, answer.problem.laws
    size, count = problem.dimension, problem.points * problem.dimension
    gaps = problem.compliance @ answer.forces + problem.free
    force, gap = answer.forces[:count].reshape(-1, size), gaps[:count].reshape(-1, size)
    f, g = max(np.abs(force).max(), 1e-300), np.abs(problem.free).max()
    layer = 0.0 if laws.series_compliance is None else laws.series_compliance
    left = gap[:, 0] + layer * force[:, 0]
    product = np.abs(force[:, 0] * left) / (f * g)
    touching = {
        "unilateral": lambda p: max(-force[p, 0] / f, -left[p] / g, product[p]),
        "bonded": lambda p: abs(left[p]) / g,
        "given": lambda p: abs(force[p, 0] - laws.given_force[p]) / f,
    }
    alongs = {
        "none": lambda p: np.abs(force[p, 1:]).max() / f,
        "bonded": lambda p: np.abs(gap[p, 1:] * force[p, 0]).max() / (f * g),
        "coulomb": lambda p: friction_violation(answer, p, force[p], gap[p, 1:], f, g),
    }
    found = [np.abs(gaps[count:]).max(initial=0.0)]
    for point in range(problem.points):
        found.append(touching["unilateral" if laws.across is None else laws.across[point]](point))
        found.append(alongs["coulomb" if laws.along is None else laws.along[point]](point))
    return float(max(found))


def friction_violation(
    answer: ExactAnswer, point: int, force: Array, slip: Array, f: float, g: float
) -> float:
    """How far the friction at a point is from Coulomb's law, as friction feels its slip."""
    laws = answer.problem.laws
    metric = np.eye(len(slip)) if laws.metric is None else laws.metric[point]
    felt, needed = metric @ slip, np.linalg.solve(metric, force[1:])
    across = max(force[0], 0.0)
    bound = laws.coefficient[point] * across
    if laws.bound is not None:
        bound = laws.bound(np.full(answer.problem.points, across))[0][point]
    if laws.fixed_bound is not None and not np.isnan(laws.fixed_bound[point]):
        bound = laws.fixed_bound[point] * (across > 0)
    epsilon = 0.0 if laws.elastic_slip is None else laws.elastic_slip[point]
    if epsilon > 0:
        return float(np.abs(needed + bound * felt / max(np.linalg.norm(felt), epsilon)).max() / f)
    work = needed @ felt + bound * np.linalg.norm(felt)
    return float(max((np.linalg.norm(needed) - bound) / f, abs(work) / (f * g)))
