"""Criteria of fatigue for ParaView are those of the places, node by node."""

import numpy as np
import pytest

from fenics_contact import FatigueLimits, Fretting, Run
from fenics_contact.simulation.output.run_folder import write
from tests.analyses.fretting.test_fretting import block, body

pyvista = pytest.importorskip("pyvista")


def test_nodes_have_the_criteria_of_their_places(folder) -> None:
    asked = Fretting(depth=0.6, begin=2, limits=FatigueLimits(5.0, 8.0))
    run = Run(block(asked, degree=1), body=body(cells=(4, 2)))
    result = run.solve()
    write(run, result, folder)
    if run.problem.comm.rank > 0:
        return
    reader = pyvista.get_reader(str(folder / "fretting.pvd"))
    grid = reader.read().combine()
    places = result.fretting_places
    for name, values in places.values.items():
        found = np.asarray(grid[name])
        known = np.isfinite(found)
        for point, value in zip(np.asarray(grid.points)[known], found[known], strict=True):
            number = np.linalg.norm(places.coordinates - point, axis=1).argmin()
            assert np.linalg.norm(places.coordinates[number] - point) < 1e-6
            assert value == pytest.approx(values[number], rel=1e-6)
        shown = np.unique(np.round(np.asarray(grid.points)[known], 6), axis=0)
        assert len(shown) == np.isfinite(values).sum()  # none is left out
        assert len(shown) < grid.n_points  # the body goes on beyond the depth
    assert np.isfinite(np.asarray(grid["displacement"])).all()
