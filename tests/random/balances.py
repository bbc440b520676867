"""What an answer with couplings, turned supports, temperatures must satisfy, from its fields alone.

Nodal forces are assembled here from the displacements, loads from the scene, and what results say
is held against these: of the program only the spaces, the displacements and its records are used.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from fenics_contact import Profile, Result, Run, Spring
from fenics_contact.common import form_cache
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.scene.loading.couplings import GROUND, Way, ways_of
from fenics_contact.scene.values import AXES

Array = NDArray[np.float64]
# Of the sum of all nodal forces; of the largest displacement; of what springs that hold allow.
_FORCE, _MOTION, _HELD = 1e-6, 1e-9, 1e-3


@dataclass(frozen=True)
class Balance:
    """What of an answer does not balance, and what is small beside its forces and motions.

    Attributes:
        faults: In words; empty where all balances.
        sizes: All forces at nodes from outside (``force``), these times the reach of the scene
            (``moment``), the largest displacement, and that over the reach (``rotation``).
    """

    faults: tuple[str, ...] = ()
    sizes: Mapping[str, float] = field(default_factory=dict)


def balance_of(solved: Run, result: Result, stress: float | None = None) -> Balance:
    """Hold an answer against what it must satisfy; collective.

    Args:
        solved: The run.
        result: What it found.
        stress: That of a body which expands freely has to be round-off beside (stress).
    """
    if any(_has_kink(given.value) for given in solved.scene.temperature):
        return Balance()  # within cells, whose strains are no polynomials then
    of = _Fields(solved, result)
    checks = (_inside, _of_couplings, _of_springs, _of_faces, _whole, _of_supports, _energies)
    found = tuple(text for check in checks for text in check(of))
    if stress is not None:
        found += tuple(_unstressed(of, stress))
    reach = max(of.spaces.comm.allgather(np.ptp(of.places)))
    sizes = {"force": of.scale, "moment": of.scale * reach}
    return Balance(found, sizes | {"displacement": of.largest, "rotation": of.largest / reach})


class _Fields:
    """Displacements, and forces at nodes that something outside the body must exert; collective.

    Attributes:
        outside: Internal forces less loads, (nodes, components) (force).
        loads: Forces of loads, likewise.
        scale: What forces are small against: all nodal forces outside (force).
        strain_energy: Of the body (energy).
        free_work: ½ ∫ σ : e₀ of strains e₀ that are free of stress (energy).
    """

    def __init__(self, solved: Run, result: Result) -> None:
        self.scene, self.result, self.solution = solved.scene, result, solved.solution
        self.problem, self.spaces = solved.problem, solved.problem.spaces
        self.body, self.size = self.spaces.body, self.scene.dimension
        self.own = slice(self.spaces.owned_nodes)
        self.moved = np.array(self.solution.displacement)
        self.places = self.spaces.coordinates[:, : self.size]
        self.time = self.scene.load_steps.last
        self.ring = self.scene.kinematics == "axisymmetric"
        place = ufl.SpatialCoordinate(self.body.mesh)
        self._weight = 2 * ufl.pi * place[0] if self.ring else 1.0
        internal, self.strain_energy, self.free_work = self._internal()
        self.loads = self._of_loads()
        self.outside = internal - self.loads
        # What moves these scenes strains them by some 1e-4; far below that all is round-off.
        length = float(max(self.spaces.comm.allgather(np.ptp(self.places))))
        least = 1e-8 * self.scene.material[0].youngs_modulus * length ** (2 if self.ring else 1)
        least *= length if self.size == 3 else 1.0
        # Loads that springs bear by themselves leave their round-off, too.
        given = sum(abs(f) for c in self.scene.coupling for f in c.force or ())
        self.scale = max(float(self.sum(np.abs(self.outside)).sum()), least, given)
        self.largest = max(self.most(self.moved), 1e-8 * length)
        # Springs that hold a body which they move as a whole leave this round-off.
        self.energy = least / length * self.largest**2 * 1e8

    def sum(self, values: Array) -> Array:
        """Over the nodes of all ranks."""
        return np.asarray(self.spaces.comm.allreduce(np.asarray(values)[self.own].sum(axis=0)))

    def most(self, values: Array) -> float:
        """The largest size over the nodes of all ranks."""
        return float(max(self.spaces.comm.allgather(np.abs(values[self.own]).max(initial=0.0))))

    def on(self, name: str) -> NDArray[np.bool_]:
        """Whether each node of this rank lies on a boundary."""
        found = np.zeros(len(self.places), dtype=bool)
        found[self.spaces.nodes(self.body.groups[name])] = True
        return found

    def measure(self, name: str) -> ufl.Measure:
        """Of a boundary, weighted as the model says."""
        return self.spaces.boundary(self.body.groups[name])

    def centroid(self, name: str) -> Array:
        """Of a boundary."""
        place, weight = ufl.SpatialCoordinate(self.body.mesh), self._weight
        densities = [weight, *(weight * place[axis] for axis in range(self.size))]
        area, *moments = (self.scalar(one * self.measure(name)) for one in densities)
        return np.array(moments) / area

    def normal(self, name: str) -> Array:
        """Mean of the normal over a flat boundary, (components,)."""
        normal = ufl.FacetNormal(self.body.mesh)
        found = [self.scalar(normal[axis] * self.measure(name)) for axis in range(self.size)]
        return np.array(found) / np.linalg.norm(found)

    def scalar(self, form: ufl.Form) -> float:
        """A form over the body."""
        return float(self.spaces.comm.allreduce(fem.assemble_scalar(form_cache.form(form))))

    def moment(self, at: Array, forces: Array) -> Array:
        """Of nodal forces about a point, (3,)."""
        return self.sum(np.cross(in_space(self.places - at), in_space(forces)))

    def _internal(self) -> tuple[Array, float, float]:
        """∫ σ : ε(v) at nodes, ½ ∫ σ : (ε − e₀), ½ ∫ σ : e₀; of isotropic bodies."""
        space = self.spaces.displacement_space
        displacement = fem.Function(space)
        displacement.x.array[:] = self.moved.reshape(-1)
        free = self._free_strain()
        strain, virtual = self._strain(displacement) - free, self._strain(ufl.TestFunction(space))
        self.stress = stress = self._stress(strain)
        form = self._weight * ufl.inner(stress, virtual) * self.spaces.bulk
        energies = [
            self.scalar(0.5 * self._weight * ufl.inner(stress, part) * self.spaces.bulk)
            for part in (strain, free)
        ]
        return self.spaces.assemble(form_cache.form(form)), *energies

    def _stress(self, strain: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
        """Of an elastic strain, (3, 3)."""
        materials = self.scene.material
        young = self._by_material([one.youngs_modulus for one in materials])
        ratio = self._by_material([one.poissons_ratio for one in materials])
        shear, lame = young / 2 / (1 + ratio), young * ratio / (1 + ratio) / (1 - 2 * ratio)
        identity, mixed = ufl.Identity(3), self.problem.elastic.mixed
        if self.scene.kinematics == "plane stress":
            lame = 2 * lame * shear / (lame + 2 * shear)
        if mixed is not None:  # the mean stress is an unknown
            deviator = strain - ufl.tr(strain) / 3 * identity
            return 2 * shear * deviator + mixed.mean_stress * identity
        return 2 * shear * strain + lame * ufl.tr(strain) * identity

    def _by_material(self, values: Sequence[float]) -> fem.Function:
        """A number of each material, in each of its cells."""
        found = fem.Function(fem.functionspace(self.body.mesh, ("DG", 0)))
        for material, value in zip(self.scene.material, values, strict=True):
            found.x.array[self._cells(material.on)] = value
        return found

    def _cells(self, *names: str) -> NDArray[np.int32]:
        """Cells of this rank that are of all these groups; an empty name stands for all."""
        topology = self.body.mesh.topology
        index_map = topology.index_map(topology.dim)
        found = np.arange(index_map.size_local + index_map.num_ghosts, dtype=np.int32)
        for name in filter(None, names):
            found = np.intersect1d(found, self.body.entities(self.body.groups[name]))
        return found

    def _free_strain(self) -> ufl.core.expr.Expr:
        """e₀, (3, 3), of temperatures and of bolts that are tight; in plane stress in the plane."""
        mesh, flat = self.body.mesh, self.scene.kinematics == "plane stress"
        space = fem.functionspace(mesh, ("DG", self.spaces.degree - 1))
        rows = [fem.Function(space) for _ in range(3)]
        for given in self.scene.temperature:
            for material in self.scene.material:
                cells = self._cells(given.on, material.on)
                rise = fem.Function(space)
                rise.interpolate(partial(_over, given.value, material.reference_temperature))
                dofs = space.dofmap.list[cells]
                alpha = np.broadcast_to(material.thermal_expansion, 3)
                for row, along in zip(rows, alpha, strict=True):
                    row.x.array[dofs] = rise.x.array[dofs] * along * given.path(self.time)
        for preload in self.scene.preload:
            cells, axis = self._cells(preload.on), int(np.argmax(preload.axis))
            nodes = np.unique(self.spaces.displacement_space.dofmap.list[cells])
            along = self.places[nodes, axis]
            low = min(self.spaces.comm.allgather(along.min(initial=np.inf)))
            length = max(self.spaces.comm.allgather(along.max(initial=-np.inf))) - low
            short = self.result.preloads[preload.label].elongation / length
            rows[axis].x.array[space.dofmap.list[cells]] -= short
        return ufl.diag(ufl.as_vector([rows[0], rows[1], 0.0 if flat else rows[2]]))

    def _strain(self, of: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
        """Symmetric gradient, (3, 3), with that around the axis; 0 across a plane."""
        gradient, size = ufl.grad(of), self.size
        rows = [
            [gradient[i, j] if i < size and j < size else 0.0 for j in range(3)] for i in range(3)
        ]
        if self.ring:
            rows[2][2] = of[0] / ufl.SpatialCoordinate(self.body.mesh)[0]
        return ufl.sym(ufl.as_matrix(rows))

    def _of_loads(self) -> Array:
        """Nodal forces of pressures, which are the only loads of these scenes (force)."""
        found = np.zeros_like(self.moved)
        test = ufl.TestFunction(self.spaces.displacement_space)
        normal = ufl.FacetNormal(self.body.mesh)
        for load in self.scene.load:
            density = -load.pressure * load.path(self.time) * self._weight * ufl.dot(normal, test)
            found += self.spaces.assemble(form_cache.form(density * self.measure(load.on)))
        return found

    def point(self, number: int) -> Array:
        """The point of a coupling, (components,)."""
        coupling = self.scene.coupling[number]
        return self.centroid(coupling.on) if coupling.at is None else np.array(coupling.at)

    def weighted(self, density: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
        """As the model integrates."""
        return self._weight * density

    def integral(self, density: ufl.core.expr.Expr, name: str) -> float:
        """Over a boundary."""
        return self.scalar(self.weighted(density) * self.measure(name))

    def area(self, name: str) -> float:
        """Of a boundary."""
        return self.integral(ufl.as_ufl(1.0), name)

    def extent(self, name: str) -> float:
        """Of a boundary, along an axis at the most."""
        here = self.places[self.on(name)]
        low = np.min(self.spaces.comm.allgather(here.min(axis=0, initial=np.inf)), axis=0)
        high = np.max(self.spaces.comm.allgather(here.max(axis=0, initial=-np.inf)), axis=0)
        return float((high - low).max())

    def reaches_symmetry(self, name: str) -> bool:
        """Whether a boundary has points in a plane of symmetry."""
        shared = [bool((self.on(name) & self.on(other)).any()) for other in self.scene.symmetry]
        return any(any(one) for one in self.spaces.comm.allgather(shared))

    def mirrored(self, way: Way) -> bool:
        """Whether symmetry across x keeps a coupling from moving so."""
        return bool(self.scene.symmetry) and (way[0] == "displacement") == (way[1] == "x")

    def stretch(self, spring: Spring, way: Way) -> float:
        """Of a spring along a way; of a stop what is beyond its gap, and 0 before."""
        one, other = (self.motion(name)[way] for name in spring.between)
        gap = spring.gaps(self.scene.kinematics).get(way, 0.0)
        if gap == 0:
            return one - other
        return max(one - other - gap, 0.0) if gap > 0 else min(one - other - gap, 0.0)

    def motion(self, name: str) -> dict[Way, float]:
        """How a coupling moves by what results say; the ground does not."""
        ways = ways_of(self.scene.kinematics)
        if name == GROUND:
            return dict.fromkeys(ways, 0.0)
        row = next(one for one in self.result.couplings if one.name == name)
        return {way: _entry(row.displacement, row.rotation, way) for way in ways}


def in_space(vectors: Array) -> Array:
    """With a third component, (points, 3)."""
    found = np.zeros((len(vectors), 3))
    found[:, : vectors.shape[1]] = vectors
    return found


def _entry(along: list[float], about: list[float], way: Way) -> float:
    """The entry of a way in two lists: in the plane, there is one rotation."""
    place = AXES.index(way[1])
    if way[0] == "displacement":
        return float(along[place])
    return float(about[place if len(about) == 3 else 0])


def _inside(of: _Fields) -> Iterator[str]:
    """No force acts from outside where nothing touches the body."""
    scene, free = of.scene, np.ones(len(of.places), dtype=bool)
    names = [one.on for one in (*scene.support, *scene.coupling, *scene.contact)]
    names += [one.against for one in scene.contact if one.against] + list(scene.symmetry)
    for name in names:
        free &= ~of.on(name)
    left = of.outside[free[:, None] & np.ones(of.size, dtype=bool)]
    if of.ring:
        left = of.outside[free & (of.places[:, 0] > 1e-9 * of.places[:, 0].max(initial=0.0))]
    worst = max(of.spaces.comm.allgather(np.abs(left).max(initial=0.0)))
    if not worst <= _FORCE * of.scale:
        yield f"inside: {worst / of.scale:.1e} of all forces is out of balance"


def _of_couplings(of: _Fields) -> Iterator[str]:
    """Forces and moments that results say are those of the nodes of the face."""
    reach = max(of.spaces.comm.allgather(np.ptp(of.places)))
    for number, row in enumerate(of.result.couplings):
        face = np.where(of.on(row.on)[:, None], of.outside, 0.0)
        at = of.point(number)
        force, moment = of.sum(face), of.moment(at, face)
        turned = moment if of.size == 3 else moment[2:]
        for way in ways_of(of.scene.kinematics):
            if of.mirrored(way):  # the plane of symmetry has a part of it
                continue
            arm = 1.0 if way[0] == "displacement" else reach + np.abs(at).max()
            said, found = (
                _entry(*each, way) for each in ((row.force, row.moment), (force, turned))
            )
            if not abs(said - found) <= _FORCE * of.scale * arm:
                yield f"{row.name}: {way} has {said}, of its nodes {found}"


def _of_springs(of: _Fields) -> Iterator[str]:
    """What is given to a coupling, less what springs take, acts on its face."""
    kinematics = of.scene.kinematics
    reach = max(of.spaces.comm.allgather(np.ptp(of.places) + np.abs(of.places).max()))
    for coupling, row in zip(of.scene.coupling, of.result.couplings, strict=True):
        moved = of.motion(coupling.label)
        factor = coupling.path(of.time)
        for way in ways_of(kinematics):
            if way in coupling.given:
                expected = coupling.given[way] * factor
                if not np.isclose(moved[way], expected, rtol=1e-9, atol=1e-14 * of.largest):
                    yield f"{coupling.label}: {way} is {moved[way]}, given {expected}"
                continue
            if of.mirrored(way):
                continue
            force = coupling.acting.get(way, 0.0) * factor
            size = abs(force)
            for spring in of.scene.spring:
                if coupling.label in spring.between:
                    pull = spring.by_way(kinematics).get(way, 0.0) * of.stretch(spring, way)
                    pull *= 1.0 if coupling.label == spring.between[0] else -1.0
                    force, size = force - pull, size + abs(pull)
            found = _entry(row.force, row.moment, way)
            arm = 1.0 if way[0] == "displacement" else reach
            if not abs(found - force) <= 1e-6 * size + _FORCE * of.scale * arm:
                yield f"{coupling.label}: along {way} acts {found}, given less springs {force}"


def _of_faces(of: _Fields) -> Iterator[str]:
    """Nodes of a rigid face move as d + θ × (x − at), those of another one in the mean."""
    for number, row in enumerate(of.result.couplings):
        if row.kind == "distributing":
            yield from _of_mean(of, number)
            continue
        arms = in_space(of.places - of.point(number))
        turn = np.array([0.0] * (3 - len(row.rotation)) + list(row.rotation))
        rigid = np.array(row.displacement) + np.cross(turn, arms)[:, : of.size]
        off = of.most(np.where(of.on(row.on)[:, None], of.moved - rigid, 0.0))
        if not off <= _MOTION * max(of.largest, np.abs(row.displacement).max()):
            yield f"{row.name}: nodes are {off / of.largest:.1e} off its motion"


def _of_mean(of: _Fields, number: int) -> Iterator[str]:
    """The point has the mean motion of the face, which gets a traction a + b × (x − c)."""
    row, size, ways = of.result.couplings[number], of.size, ways_of(of.scene.kinematics)
    centre, area, measure = of.centroid(row.on), of.area(row.on), of.measure(row.on)
    moved = fem.Function(of.spaces.displacement_space)
    moved.x.array[:] = of.moved.reshape(-1)
    turns = [AXES.index(a) for kind, a in ways if kind == "rotation"]
    is_mirrored = {way: of.mirrored(way) and of.reaches_symmetry(row.on) for way in ways}
    turns = [axis for axis in turns if not is_mirrored["rotation", AXES[axis]]]
    place = ufl.SpatialCoordinate(of.body.mesh) - ufl.as_vector(centre)
    matrices = [np.cross(np.eye(3)[axis], np.eye(3)).T[:size, :size].tolist() for axis in turns]
    fields = [ufl.dot(ufl.as_matrix(one), place) for one in matrices]

    def on_fields(vector: ufl.core.expr.Expr) -> list[float]:
        return [of.integral(ufl.dot(field, vector), row.on) for field in fields]

    second = np.array([on_fields(one) for one in fields])
    turned, arm = np.zeros(3), in_space((of.point(number) - centre)[None])[0]
    moment = np.array([*(0.0,) * (3 - len(row.moment)), *row.moment])
    moment += np.cross(arm, in_space(np.array(row.force)[None])[0])
    by_turn = np.zeros(0)
    if turns:
        turned[turns] = np.linalg.solve(second, on_fields(moved))
        by_turn = np.linalg.solve(second, moment[turns])
    mean = np.array([of.integral(moved[axis], row.on) / area for axis in range(size)])
    mean += np.cross(turned, arm)[:size]
    off = [0.0]
    for way in ways:
        if not is_mirrored[way]:
            is_turn = way[0] == "rotation"
            found = (turned if is_turn else mean)[AXES.index(way[1])]
            told = _entry(row.displacement, row.rotation, way)
            off.append(abs(told - found) * (of.extent(row.on) if is_turn else 1.0))
    if not max(off) <= _MOTION * max(of.largest, np.abs(mean).max()):
        yield f"{row.name}: is {max(off) / of.largest:.1e} off the mean motion of its face"
    uniform = np.where([of.ring and axis == 0 for axis in range(size)], 0.0, row.force) / area
    traction = fem.Constant(of.body.mesh, uniform)  # without force and moment it is still a form
    for amount, field_of_turn in zip(by_turn, fields, strict=True):
        traction += float(amount) * field_of_turn
    work = of.weighted(ufl.dot(traction, ufl.TestFunction(of.spaces.displacement_space)))
    left = of.outside - of.spaces.assemble(form_cache.form(work * measure))
    alone = of.on(row.on)
    for other in (*of.scene.support, *of.scene.contact):
        alone &= ~of.on(other.on)
    for name in of.scene.symmetry:
        alone &= ~of.on(name)
    if of.ring:
        alone &= of.places[:, 0] > 1e-9 * of.places[:, 0].max(initial=0.0)
    worst = of.most(np.where(alone[:, None], left, 0.0))
    if not worst <= _FORCE * of.scale:
        yield f"{row.name}: nodes get {worst / of.scale:.1e} beside its traction"


def _whole(of: _Fields) -> Iterator[str]:
    """Loads, contacts with obstacles, supports and couplings together, by what results say."""
    force, moment = of.sum(of.loads), of.moment(np.zeros(of.size), of.loads)
    arm = max(of.spaces.comm.allgather(np.abs(of.places).max(initial=0.0)))
    for contact, row in zip(of.scene.contact, of.result.contacts, strict=True):
        if contact.against is None:
            force += row["quantities"]["contact_force"]
    # Two surfaces with a gap between have a moment, too, so that all contacts count here.
    nodal = BulkForces(of.problem, of.solution).contacts
    moment += of.moment(np.zeros(of.size), nodal)
    told = True
    for row in of.result.supports:
        force += row.reaction
        if row.reaction_moment is None:
            told = False
            continue
        about = np.zeros(3)
        about[: of.size] = row.moment_about
        pushed = np.zeros(3)
        pushed[: of.size] = row.reaction
        own = np.array([0, 0, row.reaction_moment]) if of.size == 2 else row.reaction_moment
        moment += own + np.cross(about, pushed)
        arm = max(arm, np.abs(about).max())
    balanced = force[1:] if of.ring else force
    if not np.abs(balanced).max() <= _FORCE * of.scale:
        yield f"whole: forces of results leave {force} of {of.scale:.2e}"
    turned = moment if of.size == 3 else moment[2:]
    if told and not of.ring and not np.abs(turned).max() <= _FORCE * of.scale * arm:
        yield f"whole: moments of results leave {turned} of {of.scale * arm:.2e}"


def _of_supports(of: _Fields) -> Iterator[str]:
    """What a support holds along turned axes stays, and what slides bears no force."""
    scene = of.scene
    touched = np.zeros(len(of.places), dtype=bool)
    for contact in scene.contact:
        for name in (contact.on, contact.against):
            touched |= of.on(name) if name else False
    for name in scene.symmetry:
        touched |= of.on(name)
    for number, support in enumerate(scene.support):
        if not support.is_elastic or not support.is_rigid:
            continue
        others = touched.copy()
        for other in (*scene.support[:number], *scene.support[number + 1 :]):
            others |= of.on(other.on)
        here = (of.on(support.on) & ~others)[:, None]
        directions, values = _directions(of, support)
        for direction, value in zip(directions, values, strict=True):
            along = np.sum(of.moved * direction, axis=1, keepdims=True)
            if value is None:
                flat = np.ptp(direction, axis=0).max(initial=0.0) < 1e-9
                force = np.sum(of.outside * direction, axis=1, keepdims=True)
                worst = of.most(np.where(here, force, 0.0))
                if flat and not worst <= _FORCE * of.scale:
                    yield f"{support.label}: bears {worst / of.scale:.1e} where it slides"
                continue
            off = of.most(np.where(here, along - value * support.path(of.time), 0.0))
            if not off <= _HELD * of.largest:
                yield f"{support.label}: gives way by {off / of.largest:.1e}"


def _directions(of: _Fields, support) -> tuple[list[Array], list[float | None]]:
    """Unit vectors at the nodes, (nodes, components), and what is held along each."""
    size, count = of.size, len(of.places)
    around = of.places / np.maximum(np.linalg.norm(of.places, axis=1), 1e-300)[:, None]
    if support.normal is not None:
        if "ring" in of.body.groups or "hub" in of.body.groups:
            return [around, np.stack([-around[:, 1], around[:, 0]], axis=1)], [support.normal, None]
        normal = of.normal(support.on)
        rest = np.linalg.svd(normal[None])[2][1:]
        rows = [normal, *rest]
        vectors = [np.broadcast_to(row, (count, size)) for row in rows]
        return vectors, [support.normal, *(None for _ in rest)]
    axes = support.axes
    held = [support.displacement.get(name) for name in axes.names(size)]
    if axes.cylindrical is not None:
        return [around, np.stack([-around[:, 1], around[:, 0]], axis=1)], held
    first = np.array(axes.x) / np.linalg.norm(axes.x)
    rows = [first, np.array([-first[1], first[0]])] if size == 2 else []
    if size == 3:
        second = np.array(axes.y) - first * (first @ axes.y)
        second /= np.linalg.norm(second)
        rows = [first, second, np.cross(first, second)]
    return [np.broadcast_to(row, (count, size)) for row in rows], held


def _has_kink(value: object) -> bool:
    return isinstance(value, Profile) and len(value.at) > 2


def _over(value: object, reference: float, x: Array) -> Array:
    """A temperature less the reference at places, (3, places)."""
    found = value
    if isinstance(value, Profile):
        found = np.interp(x[AXES.index(value.along)], value.at, value.values)
    elif callable(value):
        found = value(x)
    return np.broadcast_to(np.subtract(found, reference), x.shape[1])


def _unstressed(of: _Fields, size: float) -> Iterator[str]:
    """No stress in the plane, or in space, where a body expands freely: L₂ over the body."""
    part = ufl.as_matrix([[of.stress[i, j] for j in range(of.size)] for i in range(of.size)])
    volume = of.scalar(ufl.as_ufl(1.0) * of.spaces.bulk)
    worst = np.sqrt(of.scalar(ufl.inner(part, part) * of.spaces.bulk) / volume)
    if not worst <= 1e-10 * size:
        yield f"stresses of a free body are {worst / size:.1e} of those of a clamped one"


def _energies(of: _Fields) -> Iterator[str]:
    """Of the body and of springs; the work of all that is outside is twice both."""
    scene, told = of.scene, of.result.quantities
    work = float(of.sum(np.sum(of.outside * of.moved, axis=1)))
    work += float(of.sum(np.sum(of.loads * of.moved, axis=1)))
    size = float(of.sum(np.sum(np.abs((of.outside + of.loads) * of.moved), axis=1)))
    size = max(size, of.energy)
    by_forces = 0.5 * work - of.free_work
    size = max(size, abs(of.free_work))
    for name, found in (("of the results", told["strain_energy"]), ("by forces", by_forces)):
        if not abs(found - of.strain_energy) <= 1e-6 * size:
            yield f"strain energy {of.strain_energy}, {name} {found}"
    if scene.spring and not any(one.is_elastic for one in scene.support):
        stored = 0.0
        for spring in scene.spring:
            for way, stiffness in spring.by_way(scene.kinematics).items():
                stored += 0.5 * stiffness * of.stretch(spring, way) ** 2
        if not abs(told["spring_energy"] - stored) <= 1e-6 * (stored + size):
            yield f"springs store {stored}, results say {told['spring_energy']}"
