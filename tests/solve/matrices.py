"""Products with matrices spread over the ranks."""

from dolfinx import la


def product(matrix, nodal):
    """Owned rows of a matrix times an array; its columns may go beyond this rank's nodes."""
    local = matrix.to_scipy()
    columns = matrix.index_map(1)
    size = local.shape[1] // max(columns.size_local + columns.num_ghosts, 1)
    owned = matrix.index_map(0).size_local * size
    vector = la.vector(columns, size)
    vector.array[:owned] = nodal[:owned]
    vector.scatter_forward()
    return (local @ vector.array)[:owned]
