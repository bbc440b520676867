"""Here tests are of making meshes."""

import pytest


@pytest.fixture(autouse=True)
def _geometries_of_the_repository():
    """Each test has Gmsh make its own."""
