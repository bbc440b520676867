"""Meshes of sectors of rings made for an accuracy, against formulas of the whole ring."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Accuracy,
    Contact,
    CyclicSymmetry,
    Discretisation,
    Load,
    Material,
    MeshSource,
    Point,
    Scene,
    Support,
    SupportAxes,
    run,
)

pytestmark = pytest.mark.errors
COMM = MPI.COMM_WORLD
SECTORS, BORE, SEAT, RIM = 12, 10.0, 20.0, 40.0
E, NU = 1000.0, 0.3
# Bodies do not turn, which takes no force.
BORE_RESTS, RIM_RESTS = (
    Support(name, {"around": 0}, axes=SupportAxes(cylindrical=(0, 0, 1)))
    for name in ("shaft.bore", "hub.rim")
)


def written(tmp_path, text):
    """A geometry in a file that all ranks know."""
    file = COMM.bcast(tmp_path / "sector.geo")
    if COMM.rank == 0:
        file.write_text(text, encoding="utf-8")
    COMM.barrier()
    return str(file)


def sector(name, number, inner, outer, size):
    """A sector of a ring in Gmsh's language, whose cells are smaller beside one face of the cut."""
    n, angle = 10 * number, 2 * np.pi / SECTORS
    places = [(r * np.cos(a), r * np.sin(a)) for a in (0.0, angle) for r in (inner, outer)]
    sizes = (size, size, size / 2, size / 2)
    points = [
        f"Point({n + k}) = {{{x:.17g}, {y:.17g}, 0, {h}}};"
        for k, ((x, y), h) in enumerate(zip(places, sizes, strict=True))
    ]
    return (
        "\n".join(points)
        + f"""
Point({n + 4}) = {{0, 0, 0, {size}}};
Line({n}) = {{{n}, {n + 1}}};  Circle({n + 1}) = {{{n + 1}, {n + 4}, {n + 3}}};
Line({n + 2}) = {{{n + 2}, {n + 3}}};  Circle({n + 3}) = {{{n}, {n + 4}, {n + 2}}};
Curve Loop({number}) = {{{n}, {n + 1}, {-n - 2}, {-n - 3}}};
Plane Surface({number}) = {{{number}}};
Physical Surface("{name}") = {{{number}}};
Physical Curve("{name}.bore") = {{{n + 3}}};  Physical Curve("{name}.rim") = {{{n + 1}}};
"""
    )


def cut(*numbers):
    faces = zip(("cut", "other cut"), (0, 2), strict=True)
    every = ((name, ", ".join(str(10 * n + k) for n in numbers)) for name, k in faces)
    return "\n".join(f'Physical Curve("{name}") = {{{curves}}};' for name, curves in every)


def scene_on(file, **more):
    given = {
        "kinematics": "plane strain",
        "mesh": (MeshSource(file, order=2),),
        "material": Material(E, NU),
        "discretisation": Discretisation(2),
        "cyclic_symmetry": CyclicSymmetry("cut", "other cut", SECTORS),
    }
    return Scene(**given | more)


def widening(inner, outer, at, inside, outside):
    """Radial displacement of a ring under pressures, in plane strain (G. Lamé)."""
    wide = outer**2 - inner**2
    even = (inside * inner**2 - outside * outer**2) / wide
    steep = (inside - outside) * (inner * outer) ** 2 / wide
    return (1 + NU) / E * ((1 - 2 * NU) * even * at + steep / at)


def test_a_sector_under_pressure(tmp_path):
    """Loads balance each other, and what holds the turn takes no force."""
    file = written(tmp_path, sector("shaft", 1, BORE, RIM, 16.0) + cut(1))
    found = run(
        scene_on(
            file,
            load=(Load("shaft.bore", pressure=1),),
            point=(Point("bore", (BORE, 0.0)),),
            support=(BORE_RESTS,),
            accuracy=Accuracy(strain_energy=1e-4, of={"displacement_bore": 1e-3}),
        )
    )
    assert found.exit_code == 0, found.verdict
    assert found.accuracy.reached and len(found.levels) > 1
    moved = widening(BORE, RIM, BORE, 1.0, 0.0)
    energy = np.pi * BORE * moved / SECTORS
    bars = found.errors["displacement_bore"]["total"], found.errors["strain_energy"]["total"]
    assert abs(found.quantities["displacement_bore"][0] - moved) < bars[0] <= 1e-3 * moved
    assert abs(found.quantities["strain_energy"] - energy) < bars[1] <= 1e-4 * energy
    # Of displacements that go with the loads, not with what round-off leaves of the reaction.
    first = found.levels[0].errors["displacement_bore"]
    assert first > 0.1 * bars[0] / moved


def test_a_press_fit_that_ends_in_the_cut(tmp_path):
    """p = o / (widening of the hub − widening of the shaft) under a pressure of 1."""
    text = sector("shaft", 1, BORE, SEAT, 8.0) + sector("hub", 2, SEAT, RIM, 12.0) + cut(1, 2)
    fit, low, high = 0.02, widening(BORE, SEAT, SEAT, 0, 1), widening(SEAT, RIM, SEAT, 1, 0)
    found = run(
        scene_on(
            written(tmp_path, text),
            contact=(Contact("hub.bore", against="shaft.rim", law="none", interference=fit),),
            support=(BORE_RESTS, RIM_RESTS),
            accuracy=Accuracy(pressure_integral=1e-3),
        )
    )
    assert found.exit_code == 0, found.verdict
    assert found.accuracy.reached
    carried = fit / (high - low) * 2 * np.pi * SEAT / SECTORS
    bar = found.errors["pressure_integral"]["total"]
    assert abs(found.quantities["pressure_integral"] - carried) < bar <= 1e-3 * carried
