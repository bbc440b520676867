"""Local problems of contact with friction in files of FCLIB's format.

V. Acary, M. Brémond, T. Koziara, F. Pérignon, FCLIB: a collection of discrete 3D frictional contact
problems, Inria RT-0444 (2014). A file has the group ``fclib_local`` with W (compressed rows), the
vectors q and μ, the dimension and words, and ``solution`` with r and u. Rows of scalars are FCLIB's
λ: Vᵀ r + R λ + s = 0.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np
from scipy.sparse import coo_matrix, csc_matrix, csr_matrix

from fenics_contact.common.arrays import Array
from fenics_contact.solve.exact import ExactAnswer, LocalProblem, PointLaws

# FCLIB's mark of the two compressed forms; other numbers are those of triplets.
_BY_ROWS, _BY_COLUMNS = -2, -1


def write_problem(path: Path, answer: ExactAnswer, title: str, description: str) -> None:
    """Write a problem with Coulomb's law at all points, and its answer.

    Args:
        path: File to write.
        answer: Of the problem.
        title: Of the problem, in a few words.
        description: What it is of.
    """
    problem, count = answer.problem, answer.problem.points * answer.problem.dimension
    whole = problem.compliance
    with h5py.File(path, "w") as file:
        local = file.create_group("fclib_local")
        local["spacedim"] = np.array([problem.dimension], dtype=np.int32)
        _write_matrix(local.create_group("W"), whole[:count, :count])
        vectors = local.create_group("vectors")
        vectors["q"], vectors["mu"] = problem.free[:count], problem.laws.coefficient
        if problem.scalars:
            _write_matrix(local.create_group("V"), whole[:count, count:])
            _write_matrix(local.create_group("R"), whole[count:, count:])
            vectors["s"] = problem.free[count:]
        info = local.create_group("info")
        info["title"], info["description"] = np.bytes_(title), np.bytes_(description.encode())
        info["math_info"] = np.bytes_(f"natural map over the largest force: {answer.residual:.1e}")
        solution = file.create_group("solution")
        solution["r"], solution["u"] = answer.forces[:count], answer.gaps[:count]
        if problem.scalars:
            solution["l"] = answer.forces[count:]


def read_problem(path: Path) -> tuple[LocalProblem, Array | None, str]:
    """Read a problem.

    Args:
        path: A file of FCLIB's with a local problem.

    Returns:
        The problem, forces of the solution that the file has, else None, and its title.
    """
    with h5py.File(path) as file:
        local = file["fclib_local"]
        compliance, free = _read_matrix(local["W"]), local["vectors/q"][()]
        scalars = 0
        if "V" in local:
            to, own = _read_matrix(local["V"]), _read_matrix(local["R"])
            compliance = np.block([[compliance, to], [to.T, own]])
            free, scalars = np.append(free, local["vectors/s"][()]), len(own)
        laws = PointLaws(local["vectors/mu"][()])
        forces = file["solution/r"][()] if "solution/r" in file else None
        title = local["info/title"][()].decode() if "info/title" in local else path.stem
    return LocalProblem(compliance, free, laws, scalars=scalars), forces, title


def _write_matrix(group: Any, matrix: Array) -> None:
    rows = csr_matrix(matrix)
    numbers = {"m": matrix.shape[0], "n": matrix.shape[1], "nz": _BY_ROWS, "nzmax": rows.nnz}
    for name, number in numbers.items():
        group[name] = np.array([number], dtype=np.int32)
    group["p"], group["i"] = rows.indptr.astype(np.int32), rows.indices.astype(np.int32)
    group.create_dataset("x", data=rows.data, compression="gzip")


def _read_matrix(group: Any) -> Array:
    shape = (int(group["m"][0]), int(group["n"][0]))
    pointers, indices, values = group["p"][()], group["i"][()], group["x"][()]
    form = int(group["nz"][0])
    if form == _BY_ROWS:
        found = csr_matrix((values, indices, pointers), shape=shape)
    elif form == _BY_COLUMNS:
        found = csc_matrix((values, indices, pointers), shape=shape)
    else:
        found = coo_matrix((values, (pointers, indices)), shape=shape)
    return np.asarray(found.toarray())
