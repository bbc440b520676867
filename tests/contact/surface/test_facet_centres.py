"""Points at the centres of quadratic triangles, which no node moves alone."""

import numpy as np
from dolfinx.mesh import CellType

from tests.contact.surface.test_averaging import trace_of
from tests.scenes import box_body


def test_fitted_values_are_a_function_of_the_facets_with_the_same_sums():
    """Least squares: what is off has no product with any shape function."""
    trace = trace_of(box_body((2, 2, 1), (1, 1, 0.5), CellType.tetrahedron), "z1", "3D")
    x, y, _ = trace.coordinates.T
    known = np.ones(len(x), dtype=bool)
    quadratic = 0.3 + x - 2 * y + x * y - 3 * x**2
    np.testing.assert_allclose(trace.fitted(quadratic, known), quadratic, atol=1e-14)
    given = np.cos(7 * x) * np.exp(y)
    fitted = trace.fitted(given, known)
    nodal = trace.at_all_nodes(fitted[: len(trace.nodes)])
    np.testing.assert_allclose(trace.at_points(nodal), fitted, atol=1e-14)
    off = trace.onto_nodes((trace.weights * (fitted - given))[:, None])
    assert np.abs(off).max(initial=0) < 1e-11 * trace.weights.max(initial=0)
    assert trace.integral((fitted - given) ** 2) > 1e-6
    known[x < 0.4] = False
    beyond = np.flatnonzero(~known[len(trace.nodes) :]) + len(trace.nodes)
    assert (trace.fitted(given, known)[beyond] == given[beyond]).all()
