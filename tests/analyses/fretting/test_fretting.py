"""Fretting criteria of runs whose stress is known, and what is said of them."""

import csv
import dataclasses
import json
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from mpi4py import MPI
from scipy.sparse import csr_matrix

from fenics_contact import (
    Contact,
    Cycles,
    Discretisation,
    FatigueLimits,
    Fretting,
    Load,
    Material,
    Obstacle,
    Path,
    Run,
    Scene,
    SolverSettings,
    Steps,
    StrainLifeLine,
    Support,
    main,
)
from fenics_contact.analyses.fretting.criteria_at_places import (
    _at_cusps,
    _near_edges,
    evaluate_fretting,
)
from fenics_contact.analyses.fretting.history import StressRegion
from fenics_contact.analyses.fretting.recovery import Recovery
from fenics_contact.analytic import fatigue_criteria as criteria
from fenics_contact.analytic.critical_plane import StrainLife, swt
from fenics_contact.common.arrays import Array
from fenics_contact.simulation.output.run_folder import solve_and_write
from fenics_contact.verification.boxes import Box, boxes
from tests.messages import refused

of_rank_0 = pytest.mark.skipif(
    MPI.COMM_WORLD.size > 1, reason="places are evaluated on rank 0 alone; one rank will do"
)
E, NU = 1000.0, 0.3
PULL, PUSH = 3.0, 2.0
# Pulled once as far as three times later, then to and fro, and pressed out of phase.
PULLED = Path(time=(0, 1, 2, 3, 4, 5, 6), factor=(0, 3, 0, 1, 0, -1, 0))
PRESSED = Path(time=(0, 1, 2, 4, 6), factor=(0, 1, 1, 2, 1))
LIMITS, LINE = FatigueLimits(5.0, 8.0), StrainLifeLine(40.0, -0.1, 0.3)


def block(fretting: Fretting, ratio: float = NU, degree: int = 2, **more: object) -> Scene:
    """A block on a smooth floor, its left held, its right pulled, its top pressed."""
    kinematics = more.pop("kinematics", "plane stress")
    three = kinematics == "3D"
    held = {"z": 0.0} if three else {}
    supports = [Support("block.x0", {"x": 0})]
    if three:
        supports += [Support("block.z0", held)]
    normal = (0, 1, 0) if three else (0, 1)
    pull = (PULL, 0, 0) if three else (PULL, 0)
    return Scene(
        kinematics=kinematics,
        material=Material(E, ratio),
        discretisation=Discretisation(degree=degree),
        support=tuple(supports),
        load=(
            Load("block.x1", traction=pull, path=PULLED),
            Load("block.y1", pressure=PUSH, path=PRESSED),
        ),
        contact=(Contact("block.y0", obstacle=Obstacle("plane", normal=normal)),),
        steps=more.pop("steps", Steps(times=(1, 2, 3, 4, 5, 6))),
        solver=SolverSettings(errors="none"),
        fretting=fretting,
        **more,
    )


def body(cell: str = "quadrilateral", cells: tuple[int, ...] = (4, 2)):
    return boxes((Box("block", (0.0,) * len(cells), (2.0, 1.0, 1.0)[: len(cells)], cells),), cell)


def known(times: list[float], ratio: float = NU, kinematics: str = "plane stress") -> tuple:
    """Stress and strain of the block, exact: they are the same everywhere."""
    stress = np.zeros((1, len(times), 3, 3))
    stress[0, :, 0, 0] = [PULL * PULLED(t) for t in times]
    stress[0, :, 1, 1] = [-PUSH * PRESSED(t) for t in times]
    if kinematics == "plane strain":
        stress[0, :, 2, 2] = ratio * (stress[0, :, 0, 0] + stress[0, :, 1, 1])
    trace = np.trace(stress, axis1=2, axis2=3)[..., None, None]
    return stress, ((1 + ratio) * stress - ratio * trace * np.eye(3)) / E


@pytest.mark.parametrize(
    ("kinematics", "cell", "degree", "ratio"),
    [
        ("plane stress", "quadrilateral", 2, NU),
        ("plane strain", "triangle", 1, NU),
        ("plane strain", "triangle", 2, 0.4999),
        ("3D", "tetrahedron", 2, NU),
    ],
)
def test_uniform_stress(kinematics, cell, degree, ratio) -> None:
    """At all places near the contact the criteria of the known history, and no error."""
    asked = Fretting(depth=0.6, begin=2, limits=LIMITS, life=LINE)
    cells = (2, 1, 1) if kinematics == "3D" else (4, 2)
    scene = block(asked, ratio, degree, kinematics=kinematics)
    result = Run(scene, body=body(cell, cells)).solve()
    assert result.converged, result.verdict
    stress, strain = known([2, 3, 4, 5, 6], ratio, kinematics)
    parameter, normal = swt(stress, strain)
    line = StrainLife(40.0, -0.1, 0.3, -0.6)
    alphas = criteria.crossland_alpha(5, 8), criteria.dang_van_alpha(5, 8)
    expected = {
        "swt": parameter,
        "crossland": criteria.crossland(stress, alphas[0]),
        "dang_van": criteria.dang_van(stress, alphas[1]),
        "life": line.cycles(parameter, E),
        "shear_amplitude": criteria.deviator_amplitudes(stress)[0],
        "max_mean_stress": criteria.mean_stress(stress).max(axis=1),
    }
    places, found = result.fretting_places, result.fretting
    assert places is not None and found is not None and found.steps == 5
    assert set(places.values) == set(expected)
    for name, value in expected.items():
        off = np.abs(places.values[name] - value[0])
        assert max(off.max(), places.bars[name].max()) < 1e-5 * max(value[0], PULL * 1e-3), name
    assert places.coordinates[:, 1].max() <= 0.6 + 1e-9
    assert places.coordinates[:, 1].max() > 0.4 or degree == 1
    on_surface = np.array([name == "block.y0" for name in places.contact])
    assert on_surface.tolist() == (np.abs(places.coordinates[:, 1]) < 1e-9).tolist()
    worst = found.worst["swt"]
    assert abs(np.dot(worst.plane, normal[0])) == pytest.approx(1, abs=1e-6)
    assert worst.life == pytest.approx(expected["life"][0], rel=1e-4)
    factor = found.worst["crossland"].safety_factor
    assert factor == pytest.approx(5.0 / expected["crossland"][0], rel=1e-5)


def test_of_cycles_only_the_last_counts() -> None:
    """What came before, three times as large, does not; nor does where the cycle is begun."""
    scene = block(Fretting(depth=0.6), cycles=Cycles(begin=2, end=6, number=3, increments=8))
    result = Run(scene, body=body()).solve()
    stress, strain = known(np.linspace(2, 6, 9).tolist())
    assert result.fretting is not None and result.fretting.steps == 9
    assert result.fretting.worst["swt"].value == pytest.approx(swt(stress, strain)[0][0], rel=1e-5)
    assert "crossland" not in result.fretting.worst and result.fretting.worst["swt"].life is None


def test_from_the_unloaded_body_on() -> None:
    """Without cycles all load steps are one, and the body is at rest before the first."""
    result = Run(block(Fretting(depth=0.6)), body=body()).solve()
    stress, strain = known([0, 1, 2, 3, 4, 5, 6])
    assert result.fretting is not None and result.fretting.steps == 7
    assert result.fretting.worst["swt"].value == pytest.approx(swt(stress, strain)[0][0], rel=1e-5)


def test_nothing_touches() -> None:
    """A floor out of reach: no place, and the verdict says so."""
    scene = block(Fretting(depth=0.6))
    away = Obstacle("plane", position=(0, -1), normal=(0, 1))
    contact = dataclasses.replace(scene.contact[0], obstacle=away)
    held = (Support("block.x0", {"x": 0, "y": 0}),)
    scene = dataclasses.replace(scene, contact=(contact,), support=held)
    result = Run(scene, body=body()).solve()
    assert result.fretting is not None and result.fretting.places == 0
    assert not result.fretting.worst and "no contact touches" in result.verdict


def cubic(places: Array) -> Array:
    x, y = places[..., 0], places[..., 1]
    return np.asarray(np.sin(1.3 * x) * np.exp(0.7 * y))


@of_rank_0
@pytest.mark.parametrize("cell", ["triangle", "quadrilateral"])
@pytest.mark.parametrize("degree", [1, 2])
def test_recovery(cell: str, degree: int) -> None:
    """Polynomials of the degree come out as they are; the error of others falls at their order.

    That of the plainer recovery does so more slowly at boundaries, or from a larger error.
    """
    errors = []
    for number in (8, 16):
        scene = block(Fretting(depth=9.0), degree=degree)
        problem = Run(scene, body=body(cell, (number, number))).problem
        cells = StressRegion(problem, 9.0).cells
        assert cells is not None
        recovery = Recovery(cells, degree)
        better, plainer = recovery.weights(np.arange(len(recovery.node)))
        x, y = (cells.samples[..., axis].ravel() for axis in (0, 1))
        at_x, at_y = recovery.coordinates[:, 0], recovery.coordinates[:, 1]
        assert better @ (2 - 3 * x + y) == pytest.approx(2 - 3 * at_x + at_y, abs=1e-10)
        assert plainer @ np.ones(len(x)) == pytest.approx(np.ones(len(at_x)), abs=1e-12)
        if degree == 2:
            assert better @ (x * y - y**2) == pytest.approx(at_x * at_y - at_y**2, abs=1e-10)
        exact, values = cubic(recovery.coordinates), cubic(cells.samples).ravel()
        errors.append([np.abs(way @ values - exact).max() for way in (better, plainer)])
    order = np.log2(errors[0][0] / errors[1][0])
    assert order > degree + 0.7
    assert errors[1][0] < 0.6 * errors[1][1]


def peak(places: Array, root: bool) -> Array:
    """1 at (1, 0), in the middle of the floor: a cusp with a root, or a smooth hill."""
    away = np.hypot(places[..., 0] - 1, places[..., 1])
    return np.asarray(1 - np.sqrt(away) if root else np.exp(-(away**2)))


@of_rank_0
@pytest.mark.parametrize("root", [True, False])
def test_bars_of_peaks(root: bool) -> None:
    """They hold at a cusp, and at smooth peaks, where they are of second order."""
    bars = []
    for number in (8, 16, 32):
        asked = Fretting(depth=9.0, limits=LIMITS)
        problem = Run(block(asked), body=body("quadrilateral", (number, number // 2))).problem
        region = StressRegion(problem, 9.0)
        samples = None
        if region.cells is not None:
            size = peak(region.cells.samples, root).ravel()
            samples = np.zeros((2, len(size), 12))
            samples[1, :, 0], samples[1, :, 6] = size, size / E
        floor = problem.contacts[0].trace.coordinates
        history = SimpleNamespace(region=region, samples=samples, states=2)
        history.touched = partial(region.touched, [np.ones(len(floor), dtype=bool)])
        found = evaluate_fretting(problem, asked, history)
        assert found is not None
        worst = found[0].worst["swt"]
        bar, missed = worst.errors["mesh"], abs(worst.value - 1 / (2 * E))
        assert worst.at == pytest.approx([1, 0, 0], abs=1.5 / number)
        bars.append(bar)
        assert missed <= bar
        assert bar < 4 * missed or not root
    assert np.log2(bars[0] / bars[2]) / 2 > (0 if root else 1.5)


def test_files_and_words(tmp_path, capsys) -> None:
    scene = block(Fretting(depth=0.6, begin=2, limits=LIMITS, life=LINE))
    prepared = Run(scene, body=body())
    folder = prepared.problem.comm.bcast(tmp_path)
    result = solve_and_write(prepared, folder)
    assert result.fretting is not None
    record = json.loads((folder / "result.json").read_text())["fretting"]
    with (folder / "fretting.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == record["places"] > 10
    for name in ("swt", "crossland", "dang_van"):
        largest = max(float(row[name]) for row in rows)
        assert largest == pytest.approx(record["worst"][name]["value"], rel=1e-7)
        assert record["worst"][name]["errors"]["total"] is None


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"contact": ()}, "fretting_without_contact"),
        ({"fretting": Fretting(depth=1, begin=7)}, "fretting_begins_after_the_end"),
        (
            {"fretting": Fretting(depth=1, begin=1), "cycles": Cycles(begin=2, end=6)},
            "begin_with_cycles",
        ),
        (
            {
                "fretting": Fretting(depth=1, life=LINE),
                "material": (Material(stiffness=np.diag([9.0] * 3 + [3.0] * 3).tolist()),),
            },
            "fretting_life_needs_youngs_modulus",
        ),
    ],
)
def test_what_cannot_be_is_refused(changes, said) -> None:
    with refused(said):
        dataclasses.replace(block(Fretting(depth=1)), **changes)


def test_limits_under_which_mean_stress_does_good_are_refused() -> None:
    with refused("tension_outside_its_range"):
        FatigueLimits(torsion=5, tension=9)


@pytest.mark.serial
def test_check_says_what_will_be_looked_at(tmp_path, capsys) -> None:
    path = tmp_path / "cycle.toml"
    assert main(["new", "cycle", "--out", str(path), "--quiet"]) == 0
    with path.open("a") as file:
        file.write("\n[fretting]\ndepth = 0.5\nlimits = { torsion = 5, tension = 8 }\n")
    capsys.readouterr()
    assert main(["check", str(path)]) == 0
    printed = capsys.readouterr().out
    assert "Fretting: SWT, Crossland, Dang Van, by the stress over " in printed
    assert "up to 0.5 from where contacts touch" in printed


def test_a_rank_that_has_no_cells_near_a_contact_goes_along():
    """A long strip with a small contact at its left end, on one rank or on two."""
    strip = boxes((Box("strip", (0, 0), (16, 1), (64, 4)),))
    ball = Obstacle("parabola", radius=2, position=(0.5, 0), indentation=0.02)
    scene = Scene(
        kinematics="plane strain",
        material=Material(E, NU),
        support=(Support("strip.y1", {"x": 0, "y": 0}),),
        contact=(Contact("strip.y0", obstacle=ball),),
        steps=Steps(2),
        solver=SolverSettings(errors="none"),
        fretting=Fretting(depth=0.3),
    )
    prepared = Run(scene, MPI.COMM_WORLD, strip)
    spaces = prepared.problem.spaces
    far = spaces.coordinates[: spaces.owned_nodes, 0].min() > 2
    if MPI.COMM_WORLD.size == 2:
        assert MPI.COMM_WORLD.allreduce(int(far)) == 1
    found = prepared.solve()
    assert found.fretting is not None
    assert found.fretting.worst["swt"].at[0] < 1.5


@of_rank_0
def test_bars_beside_an_edge_of_contact_follow_the_change_within_a_cell() -> None:
    """A row of eleven nodes on a surface, the first five of which touched."""
    coordinates = np.stack([np.arange(11.0), np.zeros(11), np.zeros(11)], axis=1)
    around = csr_matrix(np.eye(11) + np.eye(11, k=1) + np.eye(11, k=-1))
    near = _near_edges(coordinates, ["floor"] * 11, around, coordinates[:5], 10.0)
    assert near.tolist() == [2, 3, 4, 5, 6]
    values = np.where(np.arange(11) == 4, 8.0, 0.0)
    found = _at_cusps(np.full(11, 1.0), values, around, near)
    assert found.tolist() == [1, 1, 1, 4, 4, 4, 1, 1, 1, 1, 1]
    assert len(_near_edges(coordinates, [""] * 11, around, coordinates[:5], 10.0)) == 0
    everywhere = _near_edges(coordinates, ["floor"] * 11, around, coordinates, 10.0)
    assert len(everywhere) == 0
