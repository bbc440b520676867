"""The one place that knows dolfinx 0.9 from 0.10 and 0.11.

Imported before anything else of FEniCSx: on the PyPI wheel, ``dolfinx_solver``
must load its libraries first.
"""

from __future__ import annotations

import importlib.metadata
import importlib.util
import platform
from typing import Any

if importlib.util.find_spec("dolfinx_solver") is not None:
    import dolfinx_solver  # noqa: F401

import dolfinx
import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import NDArray

DOLFINX_VERSION = tuple(int(part) for part in dolfinx.__version__.split(".")[:2])


def model_to_mesh(model: Any, comm: MPI.Comm, dimension: int) -> tuple[Any, Any, Any]:
    """Gmsh model on rank 0 to a distributed mesh with its cell and facet tags."""
    if DOLFINX_VERSION >= (0, 10):
        from dolfinx.io import gmsh as gmsh_import

        data = gmsh_import.model_to_mesh(model, comm, 0, gdim=dimension)
        return data.mesh, data.cell_tags, data.facet_tags
    from dolfinx.io import gmshio

    found = gmshio.model_to_mesh(model, comm, 0, gdim=dimension)
    return found[0], found[1], found[2]


def boundary_entities(topology: Any, facets: NDArray[np.int32]) -> NDArray[np.int32]:
    """(cell, local facet) pairs of the owned exterior facets, as measures take them."""
    kind = fem.IntegralType.exterior_facet
    if DOLFINX_VERSION >= (0, 10):
        return fem.compute_integration_domains(kind, topology, facets)
    return fem.compute_integration_domains(kind, topology, facets, topology.dim - 1)


def interpolation_points(element: Any) -> NDArray[np.float64]:
    """Reference points at which the element interpolates."""
    points = element.interpolation_points
    return points() if callable(points) else points


def cell_geometry_dofmap(mesh: Any) -> NDArray[np.int32]:
    """Geometry nodes of every local cell, shape (cells, nodes per cell)."""
    geometry = mesh.geometry
    return geometry.dofmap if DOLFINX_VERSION < (0, 11) else geometry.dofmaps[0]


def integral_types(form: Any) -> list[str]:
    """Names of the integrals that a compiled form really holds."""
    return sorted(kind.name for kind in form._cpp_object.integral_types)


def versions() -> dict[str, str]:
    """Versions of all that a number depends on."""
    import petsc4py

    own = importlib.metadata.version("fenics-contact") if _installed() else "source"
    return {
        "fenics_contact": own,
        "dolfinx": dolfinx.__version__,
        "ufl": ufl.__version__ if hasattr(ufl, "__version__") else "",
        "petsc4py": petsc4py.__version__,
        "numpy": np.__version__,
        "python": platform.python_version(),
        "mpi": MPI.Get_library_version().splitlines()[0].strip("\x00 "),
    }


def _installed() -> bool:
    try:
        importlib.metadata.version("fenics-contact")
    except importlib.metadata.PackageNotFoundError:
        return False
    return True
