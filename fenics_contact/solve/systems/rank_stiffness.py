"""The stiffness of the cells of each rank: what ranks share is left unsummed.

So each rank can condense its own cells, with solvers that know of no other rank.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from dolfinx import fem
from scipy.sparse import bmat, csr_matrix

from fenics_contact.body.spaces import of_owners, summed_over_ranks
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import total
from fenics_contact.problem.discrete_body import DiscreteBody
from fenics_contact.problem.motion_states import StepStiffness
from fenics_contact.solve.systems.cut_transform import RankTransform


class LocalStiffness:
    """K, or [[K, Bᵀ], [B, −C]] with a mean stress, of this rank's cells.

    Its unknowns are those that its cells touch: displacements, then mean stresses. Of a sector of
    a ring they are those of ``RankTransform``.

    Attributes:
        matrix: Sparse, (unknowns, unknowns) (force/length).
        numbers: Of the unknowns over all ranks.
        shared: Which of them cells of other ranks touch, too.
        is_plane: Whether the body has two dimensions.
        displacements: Displacement dofs among them, by their local number in the space.

    Args:
        discrete: The body.
        step: What a step of motion makes of K; None for nothing.
    """

    def __init__(self, discrete: DiscreteBody, step: StepStiffness | None = None) -> None:
        self._discrete = discrete
        spaces, mixed = discrete.spaces, discrete.elastic.mixed
        self.comm = spaces.comm
        self.is_plane = spaces.components == 2
        fields = [spaces.displacement_space]
        blocks = [[_local_matrix(discrete.elastic.stiffness)]]
        if mixed is not None:
            fields.append(mixed.mean_stress.function_space)
            gradient, divergence = _local_matrix(mixed.gradient), _local_matrix(mixed.divergence)
            blocks[0].append(gradient)
            blocks.append([divergence, -_local_matrix(mixed.compressibility)])
        whole = csr_matrix(bmat(blocks)) if mixed is not None else blocks[0][0]
        every = [_Unknowns(space) for space in fields]
        sizes = [len(unknowns.sharers) for unknowns in every]
        sharers = np.concatenate([unknowns.sharers for unknowns in every])
        touched = np.flatnonzero(sharers > 0)
        starts = np.cumsum([0, *(unknowns.total for unknowns in every)])
        numbers = [unknowns.numbers + start for unknowns, start in zip(every, starts, strict=False)]
        self.matrix = whole if len(touched) == len(sharers) else whole[touched][:, touched]
        self.numbers = np.concatenate(numbers)[touched]
        self.shared = sharers[touched] > 1
        self._sharers = sharers[touched]
        self.displacements = touched[touched < sizes[0]]
        self._stresses = touched[touched >= sizes[0]] - sizes[0]
        if step is not None:
            self.matrix = csr_matrix(step.of_bulk * self.matrix + self._at_nodes(step.nodal))
        self._of_cells, self._transform = self.matrix, self._across_cut()

    def _across_cut(self) -> RankTransform | None:
        """Take unknowns by which the cut faces of a sector move alike; collective."""
        cut = self._discrete.cut
        if cut is None:
            return None
        count = len(self.displacements)
        found = RankTransform(cut, self.numbers, count, self._discrete.spaces)
        self.matrix = csr_matrix(found.matrix.T @ self.matrix @ found.matrix)
        self.matrix.sort_indices()
        self.numbers = np.concatenate([self.numbers, found.others])
        self.shared = np.concatenate([self.shared, np.ones(len(found.others), dtype=bool)])
        self.shared |= np.isin(self.numbers, found.shared)
        return found

    def held(self, constrained: Flags) -> Flags:
        """Which unknowns are held, of those that supports hold, or as jumps; collective.

        Args:
            constrained: Which displacement dofs of this rank supports hold.
        """
        found = np.zeros(len(self._sharers), dtype=bool)
        found[: len(self.displacements)] = constrained[self.displacements]
        return found if self._transform is None else self._transform.held(found, constrained)

    def _of_own(self, values: Array) -> Array:
        """Displacements and mean stresses of this rank's cells, of values of the unknowns."""
        return values if self._transform is None else np.asarray(self._transform.matrix @ values)

    def _at_nodes(self, blocks: Array) -> csr_matrix:
        """This rank's share of a matrix that couples the displacements of single nodes."""
        size = blocks.shape[1]
        nodes, rows = np.divmod(self.displacements, size)
        values = blocks[nodes, rows] / self._sharers[: len(nodes), None]
        place = np.full(len(blocks) * size, -1)
        place[self.displacements] = np.arange(len(self.displacements))
        columns = place[nodes[:, None] * size + np.arange(size)]
        count = len(self.numbers)
        lines = np.broadcast_to(np.arange(len(nodes))[:, None], columns.shape)
        return csr_matrix((values.ravel(), (lines.ravel(), columns.ravel())), (count, count))

    def places(self) -> tuple[Array, Integers]:
        """Where each unknown is (unknowns, 3) (length), and which one of its node it is."""
        spaces, mixed = self._discrete.spaces, self._discrete.elastic.mixed
        nodes, kinds = np.divmod(self.displacements, spaces.components)
        found = [(spaces.coordinates[nodes], kinds)]
        if mixed is not None:
            every = mixed.mean_stress.function_space.tabulate_dof_coordinates()
            last = np.full(len(self._stresses), spaces.components)
            found.append((every[self._stresses], last))
        if self._transform is not None:
            found.append(self._transform.places)
        places, which = (np.concatenate(part) for part in zip(*found, strict=True))
        return places, which

    def share(self, nodal: Array, on_mean_stress: Array | None = None) -> Array:
        """This rank's share of forces, at its unknowns.

        Args:
            nodal: On displacements, (nodes, components).
            on_mean_stress: On mean stresses, at all dofs of this rank; None for none.
        """
        found = np.zeros(len(self._sharers))
        count = len(self.displacements)
        found[:count] = nodal.reshape(-1)[self.displacements] / self._sharers[:count]
        if on_mean_stress is not None and len(on_mean_stress):
            found[count:] = on_mean_stress[self._stresses] / self._sharers[count:]
        if self._transform is None:
            return found
        return np.asarray(self._transform.matrix.T @ found)

    def whole(self, share: Array) -> Array:
        """Forces on the unknowns of which each rank has its share, at the nodes; collective."""
        found = self._summed(share)
        if self._transform is None:
            return found
        return found + self._transform.of_others(share, found.shape)

    def _summed(self, share: Array) -> Array:
        """The same of displacements of this rank's own cells; collective."""
        spaces = self._discrete.spaces
        found = np.zeros(spaces.coordinates.shape[0] * spaces.components)
        found[self.displacements] = share[: len(self.displacements)]
        return spaces.summed(found.reshape(-1, spaces.components))

    def nodal(self, values: Array) -> Array:
        """Displacements among values of the unknowns, at the nodes; collective."""
        return self._summed(self._of_own(values) / self._sharers)

    def load(self, nodal: Array, supported: Array, held: Flags) -> Array:
        """This rank's share of a load, with what supports at given displacements add.

        Args:
            nodal: Forces, (nodes, components).
            supported: Displacements of supports, 0 elsewhere, (nodes, components).
            held: Which unknowns they hold; there the load is the displacement.
        """
        moved = self.at_unknowns(supported)
        found = self.share(nodal)
        if moved.any():
            found -= self.matrix @ moved
        found[held] = moved[held]
        return found

    def at_unknowns(self, nodal: Array) -> Array:
        """Nodal displacements (nodes, components) at its unknowns, no mean stress; collective."""
        found, flat = np.zeros(len(self._sharers)), nodal.reshape(-1)
        found[: len(self.displacements)] = flat[self.displacements]
        return found if self._transform is None else self._transform.unknowns(found, flat)

    def at_nodes(self, values: Array) -> Array:
        """Displacements of all nodes of this rank from those at its unknowns; collective."""
        spaces = self._discrete.spaces
        found = np.zeros(len(spaces.coordinates) * spaces.components)
        found[self.displacements] = self._of_own(values)[: len(self.displacements)]
        index_map = spaces.displacement_space.dofmap.index_map
        return of_owners(index_map, found.reshape(-1, spaces.components))

    def mean_stresses(self, values: Array) -> Array:
        """Mean stresses of all dofs of this rank, empty without any; collective."""
        mixed = self._discrete.elastic.mixed
        if mixed is None:
            return np.zeros(0)
        found = fem.Function(mixed.mean_stress.function_space)
        _set(found, self._stresses, self._of_own(values)[len(self.displacements) :])
        return np.array(found.x.array)

    def forces(self, values: Array) -> Array:
        """K u at the nodes, (nodes, components), of all ranks' cells; collective."""
        return self._summed(self._of_cells @ self._of_own(values))

    def round_off(self, values: Array) -> float:
        """20 × machine epsilon × ‖|K| |u|‖₁ (force); collective."""
        left = float(self._column_sums @ np.abs(self._of_own(values)))
        return float(20 * np.finfo(float).eps * total(self.comm, left))

    @cached_property
    def _column_sums(self) -> Array:
        """Σ |K_ij| over the displacements' rows i, of each unknown."""
        matrix = self._of_cells
        last = matrix.indptr[len(self.displacements)]
        columns, sizes = matrix.indices[:last], np.abs(matrix.data[:last])
        return np.bincount(columns, sizes, matrix.shape[1])

    def set_functions(self, values: Array) -> None:
        """Values of the unknowns into displacement and mean stress; collective."""
        count, values = len(self.displacements), self._of_own(values)
        _set(self._discrete.displacement, self.displacements, values[:count])
        mixed = self._discrete.elastic.mixed
        if mixed is not None:
            _set(mixed.mean_stress, self._stresses, values[count:])


class _Unknowns:
    """Numbers over all ranks of a space's dofs, and how many ranks' cells touch each."""

    def __init__(self, space: fem.FunctionSpace) -> None:
        dofmap, mesh = space.dofmap, space.mesh
        index_map, size = dofmap.index_map, dofmap.index_map_bs
        count = self.count(space) // size
        own_cells = mesh.topology.index_map(mesh.topology.dim).size_local
        touched = np.zeros(count)
        touched[dofmap.list[:own_cells].ravel()] = 1.0
        sharers = summed_over_ranks(index_map, touched[:, None])[:, 0]
        self.sharers = np.repeat(np.where(touched > 0, sharers, 0.0), size)
        nodes = index_map.local_to_global(np.arange(count, dtype=np.int32))
        self.numbers = (nodes[:, None] * size + np.arange(size)).ravel()
        self.total = index_map.size_global * size

    @staticmethod
    def count(space: fem.FunctionSpace) -> int:
        """Number of dofs that this rank knows of."""
        index_map = space.dofmap.index_map
        return int(index_map.size_local + index_map.num_ghosts) * int(space.dofmap.index_map_bs)


def _local_matrix(form: fem.Form) -> csr_matrix:
    """A bilinear form over this rank's cells, between its own local dofs; collective."""
    test, trial = form.function_spaces
    if test.dofmap.index_map_bs == trial.dofmap.index_map_bs:
        found = csr_matrix(fem.assemble_matrix(form).to_scipy(ghosted=True))
    else:  # of unequal blocks only PETSc makes matrices, and not as fast
        from dolfinx.fem import petsc as fem_petsc  # loads a parser of C, which others do without

        matrix = fem_petsc.create_matrix(form, "is")
        fem_petsc.assemble_matrix(matrix, form)
        matrix.assemble()
        local = matrix.getISLocalMat()
        first, columns, values = local.getValuesCSR()
        found = csr_matrix((values, columns, first), shape=local.getSize())
        matrix.destroy()
    # Rows that ranks share have made room for columns that none of its cells reach.
    shape = (_Unknowns.count(test), _Unknowns.count(trial))
    return found if found.shape == shape else found[: shape[0], : shape[1]]


def _set(function: fem.Function, dofs: Integers, values: Array) -> None:
    """Values at this rank's dofs; those that only ghost cells touch come from their owners."""
    function.x.array[dofs] = values
    function.x.scatter_forward()
