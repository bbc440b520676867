"""``state.npz``: the last accepted load step, for another run to go on from.

It is replaced in one move after every step, so that it is whole whenever the run is killed, and
any number of ranks can read it.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fenics_contact.analyses import registry
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.atomic_files import make_folder
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import on_root, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.problem.problem import Problem
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.results.result import steps_of
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation import fingerprint
from fenics_contact.simulation.fingerprint import keys_in_format_1
from fenics_contact.simulation.row_tables import (
    NodalKeys,
    Rows,
    SavedTables,
    read_header,
    replace_header,
    write,
)
from fenics_contact.solve.load_steps.accepted_step import (
    AcceptedStep,
    AuxiliaryState,
    ContactMemory,
    Unknowns,
    remember,
)
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.load_steps.step_control import has_ended
from fenics_contact.solve.systems.solution import BodyAnswer, Solution

NAME = "state.npz"
# Of the file. Those without a number are of format 1, whose fingerprints have keys with defaults.
_FORMAT = 2


@dataclass(frozen=True, eq=False)
class SavedRun:
    """State that a run had reached.

    Attributes:
        last: Its last accepted load step.
        steps: Records of all steps.
        pace: What is to come next.
        forces: Largest of all steps (force).
        energy: Sums of its energy balance.
        exit_code: Of a run that came to its end; else None.
        auxiliary: What was kept beside the step.
    """

    last: AcceptedStep
    steps: list[StepRecord]
    pace: list[float]
    forces: float
    energy: list[float]
    exit_code: int | None
    auxiliary: AuxiliaryState

    @property
    def time(self) -> float:
        """Pseudo-time that was reached, of all cycles."""
        return self.steps[-1].load_factor

    def is_done(self, scene: Scene) -> bool:
        """Whether nothing is left to do of a scene."""
        reached = self.time >= scene.load_steps.last * (1 - 1e-9)
        if registry.takes_steps_of(scene) is None:  # else none ends before the last
            reached = reached or has_ended(scene, self.pace)
        return self.exit_code is not None and reached


class StateFile:
    """The state file of a problem in a folder.

    Args:
        folder: Of the results.
        problem: The model, as made ready.
        scene: By which the run is known, if not that of the problem.
    """

    def __init__(self, folder: Path, problem: Problem, scene: Scene | None = None) -> None:
        self.path = folder / NAME
        self._problem, self._comm = problem, problem.comm
        self._nodes = NodalKeys(problem.body.mesh, problem.spaces.displacement_space.dofmap)
        self._mixed = problem.elastic.mixed
        if self._mixed is not None:
            dofmap = self._mixed.mean_stress.function_space.dofmap
            self._mean_stresses = NodalKeys(problem.body.mesh, dofmap)
        self._scene = scene or problem.scene
        self._made_for = {
            "format": _FORMAT,
            "version": compat.versions()["fenics_contact"],
            "mesh": fingerprint.of_mesh(problem.body),
            "several": problem.scene.load_steps.several,
            "scene": fingerprint.of_scene(self._scene, problem.body),
        }

    def make_folder(self) -> None:
        """Make the folder where there is none; collective. It is not made again later on."""
        on_root(self._comm, lambda: make_folder(self.path.parent))

    def remove(self) -> None:
        """Take away that of an earlier run; collective."""
        on_root(self._comm, lambda: self.path.unlink(missing_ok=True))

    def save(
        self,
        load_steps: LoadSteps,
        steps: list[StepRecord],
        energy: list[float],
        auxiliary: AuxiliaryState | None = None,
    ) -> None:
        """Write the last accepted step of a history; collective.

        Args:
            load_steps: Of the run.
            steps: Records of all steps.
            energy: Sums of the energy balance.
            auxiliary: What else is to be kept.

        Raises:
            MachineError: It could not be written; that of the step before is still there.
        """
        last, auxiliary = load_steps.last, auxiliary or AuxiliaryState()
        assert last is not None
        header = {
            "made_for": self._made_for,
            "last": _plain_unknowns(last.unknowns),
            "before": None if last.before is None else _plain_unknowns(last.before),
            "steps": [step.as_dict() for step in steps],
            "pace": load_steps.pace.state,
            "forces": load_steps.newton.system.earlier_forces,
            "energy": energy,
            "exit_code": None,
            "contacts": [_plain_part(memory) for memory in last.contacts],
            "beside": auxiliary.said,
            "beside_at_points": list(auxiliary.of_contact(0)),
            "beside_nodal": list(auxiliary.nodal),
            "solution": {
                "strategy": last.solution.strategy,
                "imbalance_limit": last.solution.imbalance_limit,
            },
        }
        write(self._comm, self.path, header, self._tables(last, auxiliary))

    def finish(self, exit_code: int) -> None:
        """Say in it that the run came to its end; collective."""

        def say() -> None:
            header = read_header(self.path)
            replace_header(self.path, header | {"exit_code": exit_code})

        on_root(self._comm, say)

    def load(self) -> SavedRun | None:
        """Return the state that another run had reached, None without a file; collective.

        Raises:
            InputError: It is damaged, or of another scene, mesh or version.
        """
        if not on_root(self._comm, self.path.exists):
            return None
        saved = SavedTables(self._comm, self.path)
        header = saved.header
        self._require_same(header["made_for"])
        said, steps = header["solution"], steps_of(header["steps"])
        nodal, mean_stresses = self._read(saved, self._nodes, "nodes"), {}
        if self._mixed is not None:
            mean_stresses = self._read(saved, self._mean_stresses, "mean_stresses")
        more = header["beside_at_points"]
        contacts, at_points = [], []
        for number, plain in enumerate(header["contacts"]):
            memory = self._contact(number, plain, saved, nodal, more)
            at_points.append({name: memory.at_points.pop(name) for name in more})
            contacts.append(memory)
        last = AcceptedStep(
            unknowns=_unknowns(header, "last", nodal, mean_stresses),
            contacts=contacts,
            solution=Solution(
                find_body=lambda: BodyAnswer(np.zeros(0), np.zeros(0)),
                normal_force=[],
                friction_force=[],
                friction_bound=[],
                states=[],
                residual_history=tuple(np.array(steps[-1].residual_history, dtype=float).tolist()),
                newton_iterations=steps[-1].newton_iterations,
                outer_iterations=steps[-1].outer_iterations,
                strategy=said["strategy"],
                imbalance_limit=said["imbalance_limit"],
                factorisations=0,
            ),
            before=None
            if header["before"] is None
            else _unknowns(header, "before", nodal, mean_stresses),
        )
        return SavedRun(
            last=last,
            steps=steps,
            pace=header["pace"],
            forces=header["forces"],
            energy=header["energy"],
            exit_code=header["exit_code"],
            auxiliary=AuxiliaryState(
                header["beside"],
                at_points,
                {name: nodal[name] for name in header["beside_nodal"]},
            ),
        )

    def _require_same(self, made_for: dict[str, Any]) -> None:
        """Refuse what another version, mesh or scene has left."""
        ours, theirs = self._made_for["version"], made_for["version"]
        if theirs != ours:
            raise self._refused(f"version {theirs} wrote it, this is {ours}")
        scene = self._fingerprint(made_for.get("format", 1))
        if other := fingerprint.differences(scene, made_for["scene"]):
            raise self._refused(
                f"the scene's {' and '.join(other)} differ; only how it is solved and what is "
                "asked of its answer may"
            )
        if self._made_for["several"] != made_for["several"]:
            raise self._refused("of the two, one has a single load step and the other several")
        if self._made_for["mesh"] != made_for["mesh"]:
            raise self._refused("it is of another mesh")

    def _fingerprint(self, number: int) -> dict[str, str]:
        """Fingerprint of the scene as state files of a format have it; collective."""
        if number == 1:
            return fingerprint.of_scene(self._scene, self._problem.body, keys_in_format_1)
        if number != _FORMAT:
            raise self._refused(f"its format is {number}, this version reads 1 and {_FORMAT}")
        scene = self._made_for["scene"]
        assert isinstance(scene, dict)
        return scene

    def _refused(self, why: str) -> InputError:
        return InputError(f"--resume: '{self.path}' does not belong here: {why}")

    def _tables(self, last: AcceptedStep, auxiliary: AuxiliaryState) -> dict[str, Rows]:
        """This rank's own rows of all that stands at nodes and facets; collective."""
        keys, own = self._nodes.own()
        states = {"last": last.unknowns} | ({} if last.before is None else {"before": last.before})
        nodal = {name: unknowns.displacement[own] for name, unknowns in states.items()}
        nodal |= {name: values[own] for name, values in auxiliary.nodal.items()}
        tables: dict[str, Rows] = {}
        for number, memory in enumerate(last.contacts):
            tables |= self._of_contact(number, memory.at_points | auxiliary.of_contact(number))
            if memory.paired_at is not None:
                nodal[_paired_at(number)] = memory.paired_at[own]
        tables["nodes"] = Rows(keys, nodal)
        if self._mixed is not None:
            keys, own = self._mean_stresses.own()
            columns = {name: unknowns.mean_stress[own] for name, unknowns in states.items()}
            tables["mean_stresses"] = Rows(keys, columns)
        return tables

    def _of_contact(self, number: int, at_points: dict[str, Array]) -> dict[str, Rows]:
        """Return the rows of a contact's points: at its nodes, and at its facets' centres."""
        contact = self._problem.contacts[number]
        trace = contact.trace
        values = np.column_stack(list(at_points.values()))
        count = len(trace.nodes)
        on_body = trace.surface.on_body(trace.at_all_nodes(values[:count]))
        keys, own = self._nodes.own(contact.on_body)
        return {
            f"contact{number}_nodes": Rows(keys, {"values": on_body[own]}),
            f"contact{number}_centres": Rows(
                self._centre_keys(contact), {"values": values[count:]}
            ),
        }

    def _read(self, saved: SavedTables, nodes: NodalKeys, table: str) -> dict[str, Array]:
        found = nodes.values(saved, table)
        if found is None:
            raise self._refused("its nodes are those of another mesh")
        return found

    def _contact(
        self,
        number: int,
        plain: dict[str, Any],
        saved: SavedTables,
        nodal: dict[str, Array],
        more: list[str],
    ) -> ContactMemory:
        """That of a contact, with what was kept beside, by its names; collective."""
        contact, name = self._problem.contacts[number], f"contact{number}"
        owned = contact.on_body[: self._problem.spaces.owned_nodes]
        if total(self._comm, int(owned.sum())) != saved.count(f"{name}_nodes"):
            raise self._refused(f"the contact '{contact.label}' had other facets")
        at_nodes = self._read(saved, self._nodes, f"{name}_nodes")["values"][contact.nodes]
        keys = self._centre_keys(contact)
        every = np.arange(len(keys))
        at_centres, found = saved.taken(f"{name}_centres", keys, every, len(keys))
        if total(self._comm, len(keys) - found):
            raise self._refused("its facets are those of another mesh")
        values = np.concatenate([at_nodes, at_centres["values"]])
        present = remember(contact).at_points
        present |= {name: np.zeros(len(values)) for name in more}
        wide = [array.shape[1] if array.ndim == 2 else 1 for array in present.values()]
        parts = np.split(values, np.cumsum(wide)[:-1], axis=1)
        at_points = {
            name: part.reshape(present[name].shape).copy()
            for name, part in zip(present, parts, strict=True)
        }
        return ContactMemory(**plain, at_points=at_points, paired_at=nodal.get(_paired_at(number)))

    def _centre_keys(self, contact: ContactSurface) -> Integers:
        """A number for every facet of this rank that has a point at its centre."""
        if contact.trace.nodal:
            return np.zeros(0, dtype=np.int64)
        topology = self._problem.body.mesh.topology
        cells, facets = contact.trace.surface.parents.astype(np.int64).T
        # Of a tetrahedron, no more than eight facets.
        return np.asarray(
            np.asarray(topology.original_cell_index, dtype=np.int64)[cells] * 8 + facets
        )


def _plain_part(memory: ContactMemory) -> dict[str, Any]:
    """Return the parts of a contact's state that are no arrays."""
    fields = dataclasses.fields(memory)
    parts = {field.name: getattr(memory, field.name) for field in fields}
    return {name: part for name, part in parts.items() if isinstance(part, float | bool | tuple)}


def _paired_at(number: int) -> str:
    """The column of the displacement at which a contact was paired."""
    return f"contact{number}_paired_at"


def _plain_unknowns(unknowns: Unknowns) -> dict[str, Any]:
    """Return the unknowns that belong to no node."""
    return {"time": unknowns.time, "scalars": unknowns.scalars.tolist()}


def _unknowns(
    header: dict[str, Any], name: str, nodal: dict[str, Array], mean_stresses: dict[str, Array]
) -> Unknowns:
    """The unknowns of a step by its name; a mean stress where there is one."""
    scalars = np.array(header[name]["scalars"], dtype=np.float64)
    mean_stress = mean_stresses.get(name, np.zeros(0))
    return Unknowns(header[name]["time"], lambda: nodal[name], scalars, lambda: mean_stress)
