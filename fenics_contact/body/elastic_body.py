"""The body's elastic energy, discretised so that ν → ½ neither locks nor ruins pressures.

From ν = .49 (not in plane stress, where the thickness gives way) the mean stress becomes an
unknown of its own, s = K tr(e), in a space that suits the displacement's: continuous of
degree 1 on simplices of degree 2 (Taylor and Hood), discontinuous of degree 1 on Q2 and of
degree 0 on Q1. On simplices of degree 1 it is continuous of degree 1, stabilised by its
difference from the mean of each cell (C. R. Dohrmann and P. B. Bochev, Int. J. Numer. Meth.
Fluids 46 (2004) 183-201). Between several materials the mean stress jumps: there it is constant
in each cell on simplices of degree 2; on those of degree 1 it stays continuous, and converges
only at first order.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.mesh import Mesh
from numpy.typing import NDArray
from ufl.core.expr import Expr

from fenics_contact.body.coupled_face import (
    CoupledFace,
    Joints,
    MotionForces,
    MotionsOfFaces,
    PointForces,
    SpreadForces,
    point_forces,
)
from fenics_contact.body.cyclic.cut_faces import CutFaces
from fenics_contact.body.description import BodyDescription, HeatedGroup, Joint
from fenics_contact.body.elasticity import Isotropic, Law, strain, strain_energy
from fenics_contact.body.materials import Elasticities, Moduli
from fenics_contact.body.preloaded_part import (
    PreloadedPart,
    ScalarColumns,
    ScalarForces,
    ScalarForms,
)
from fenics_contact.body.spaces import Spaces
from fenics_contact.body.springs import springs_of
from fenics_contact.body.supports import HeldDofs
from fenics_contact.body.thermal.heated_part import HeatedPart
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import total
from fenics_contact.scene.body import NEARLY_INCOMPRESSIBLE
from fenics_contact.scene.loading.temperatures import Temperature


@dataclass(frozen=True, eq=False)
class MixedForms:
    """Compiled forms that couple the displacement u with the mean stress s.

    Attributes:
        gradient: ∫ s tr(e(v)).
        divergence: ∫ t tr(e(u)).
        compressibility: ∫ s t / K, and the stabilisation where there is one.
        mean_stress: The second unknown, a dolfinx function (stress).
    """

    gradient: fem.Form
    divergence: fem.Form
    compressibility: fem.Form
    mean_stress: fem.Function


class ElasticBody:
    """½ a(v, v) and its forms; in preloaded parts of the strain beyond the one free of stress.

    Attributes:
        name: What is modelled, in words.
        displacement: The unknown, a dolfinx function.
        preloaded: Parts whose unstressed length is changed.
        heated: Parts that expand by their temperature.
        faces: Boundaries that move with a point.
        spreads: How those of these take forces that stay elastic, None of rigid ones.
        scalar_forces: What each scalar of the energy does to the body: such a change or expansion,
            then forces between points and boundaries that stay elastic, then the ways in which
            points move.
        ties: Number of those forces.
        scalar_stiffness: Second derivatives of the energy in these, (scalars, scalars), with that
            of springs between faces, but not of stops.
        joints: Springs between faces, and between these and the ground.
        springs: Those of elastic supports.
        stiffness: Compiled bilinear form: a(·, ·), or its deviatoric part if mixed, and springs.
        mixed: The forms of a mean stress, or None.
        reference_modulus: Largest stiffness of the body (stress).
        is_linear: Whether forces are those of the stiffness, whatever the displacement.
    """

    is_linear: ClassVar[bool] = True

    def __init__(
        self,
        description: BodyDescription,
        spaces: Spaces,
        displacement: fem.Function,
        held: HeldDofs,
        cut: CutFaces | None = None,
    ) -> None:
        self._spaces = spaces
        self.displacement = displacement
        self._elasticities = elasticities = Elasticities(description, spaces)
        self.law = elasticities.law
        self.reference_modulus = elasticities.reference_modulus
        self._moduli = elasticities.moduli
        self.name = "elastic energy"
        self.mixed: MixedForms | None = None
        nearly = elasticities.largest_poissons_ratio >= NEARLY_INCOMPRESSIBLE
        if nearly and description.kinematics != "plane stress":
            assert isinstance(self.law, Isotropic)
            self.name = "elastic energy, nearly incompressible: mean stress as a second unknown"
            self.mixed = self._mixed_forms(self.law, several=len(description.material) > 1)
        residual = ufl.derivative(self._energy(), displacement)
        stiffest = max(moduli.confined for moduli in self._moduli)
        self.springs = springs_of(description.springs, spaces, stiffest)
        stiffness = ufl.derivative(residual, displacement)
        u = ufl.TrialFunction(spaces.displacement_space)
        v = ufl.TestFunction(spaces.displacement_space)
        for each in self.springs:
            stiffness += each.work(u, v)
        self.stiffness = form_cache.form(stiffness)
        self.preloaded = self._place_preloads(description)
        self.heated = self._place_temperatures(description)
        self._forms_of_parts = [self._forms_of(part) for part in self._parts]
        self.scalar_forces: list[ScalarForces] = [
            forms.assembled() for forms in self._forms_of_parts
        ]
        self.faces = [
            CoupledFace(each, f"coupling[{number}]", spaces, held, cut)
            for number, each in enumerate(description.couplings)
        ]
        self.spreads = [
            None if face.described.is_rigid else SpreadForces(face, f"coupling[{n}]", spaces)
            for n, face in enumerate(self.faces)
        ]
        self._ways: list[MotionForces | PointForces] = []
        self.ties = sum(len(one.nodal) for one in self.spreads if one is not None)
        self.scalar_stiffness = np.diag([one.stiffness for one in self.scalar_forces])
        self._couple_parts()
        if self.faces:
            self._couple_faces(stiffness)
        self.joints = self.joined(description.joints)
        self.scalar_stiffness = self.scalar_stiffness + self.joints.stiffness

    def _energy(self) -> ufl.Form:
        """The elastic energy of the displacement, with a mean stress its deviatoric part."""
        u, spaces = self.displacement, self._spaces
        stress = self.displacement_stress(u)
        return strain_energy(self.strain(u), stress, spaces.weight, spaces.bulk)

    def _couple_parts(self) -> None:
        """Add what the expansion of preloaded parts does to the forces in them; collective."""
        spaces, forces, count = self._spaces, self.scalar_forces, len(self.preloaded)
        for row, tight in enumerate(self.preloaded):
            for column, heated in enumerate(self.heated, count):
                cells = np.intersect1d(spaces.body.entities(tight.group), heated.cells)
                if total(spaces.comm, len(cells)) == 0:
                    continue
                one, other = (part.stressless_strain(ufl.as_ufl(1.0)) for part in (tight, heated))
                density = spaces.weight * ufl.inner(self._stress_of(one), other)
                over = spaces.over_cells(cells, {"quadrature_degree": spaces.bulk_degree})
                own = fem.assemble_scalar(form_cache.form(density * over))
                found = float(total(spaces.comm, own))
                self.scalar_stiffness[[row, column], [column, row]] = found
                forces[row].follow([forces[column]], np.array([found]))
                forces[column].follow([forces[row]], np.array([found]))

    def _couple_faces(self, stiffness: ufl.Form) -> None:
        """Add the ways in which faces move to the scalars of the energy; collective."""
        spaces, volumes = self._spaces, None
        if self.mixed is not None:
            t = ufl.TestFunction(self.mixed.mean_stress.function_space)
            u = ufl.TrialFunction(spaces.displacement_space)
            volumes = spaces.weight * t * ufl.tr(self.strain(u)) * spaces.bulk
        find = MotionsOfFaces(spaces, stiffness, volumes)
        ties, ways = list[PointForces](), list[MotionForces | PointForces]()
        for face, spread in zip(self.faces, self.spreads, strict=True):
            if spread is None:
                ways += [find.of(moved) for moved in face.fields]
                continue
            of_ties, of_ways = point_forces(face, spread, self.reference_modulus, find.stresses)
            ties, ways = [*ties, *of_ties], [*ways, *of_ways]
        first, own = len(self._parts) + len(ties), slice(spaces.owned_nodes)
        self.scalar_forces = [*self.scalar_forces, *ties, *ways]
        nodal = np.array([one.nodal[own] for one in self.scalar_forces])
        moved = np.array([one.moved[own] for one in ways])
        works = np.asarray(total(spaces.comm, np.einsum("inc,jnc->ij", nodal, moved)))
        before, self.scalar_stiffness = self.scalar_stiffness, np.zeros((len(nodal), len(nodal)))
        self.scalar_stiffness[: len(before), : len(before)] = before
        self.scalar_stiffness[:, first:] = works
        self.scalar_stiffness[first:, :] = works.T
        for number, way in enumerate(ways):
            way.follow(self.scalar_forces[:first], works[:first, number])
        self._ways = ways
        for row, tie in enumerate(ties, len(self._parts)):
            column = next(n for n, way in enumerate(ways, first) if way.present is tie.partner)
            self.scalar_stiffness[[row, column], [column, row]] = tie.tie

    def joined(self, joints: Sequence[Joint]) -> Joints:
        """Return springs between the faces, such as one of the body's joints alone."""
        return Joints(joints, self.faces, len(self._parts) + self.ties)

    @property
    def _parts(self) -> list[PreloadedPart | HeatedPart]:
        """Parts with a strain that is free of stress."""
        return [*self.preloaded, *self.heated]

    def follow_temperature(self, rise: Array) -> None:
        """Take a temperature that was found; collective.

        Args:
            rise: Less the reference, at the nodes of this rank, (nodes,) (temperature).
        """
        for part in self.heated:
            if part.described.is_found:
                part.follow(rise)
        self._renew_heated()

    @property
    def follows_temperature(self) -> bool:
        """Whether a modulus is a table of temperature."""
        return self._elasticities.temperatures is not None

    def take_moduli(self, rise: Array | None, given: Sequence[tuple[Temperature, float]]) -> bool:
        """Take moduli at temperatures that are found or given; whether they change; collective.

        Args:
            rise: Where they are found, less the reference, at the nodes of this rank, (nodes,)
                (temperature).
            given: Else those of the scene, once their paths are 1, and their present factors.
        """
        temperatures = self._elasticities.temperatures
        if temperatures is None:
            return False
        at = temperatures.given(given) if rise is None else temperatures.found(rise)
        if not self._elasticities.follow(at):
            return False
        self._renew_parts(0)
        return True

    def take_fields(self, heated: Sequence[HeatedGroup]) -> None:
        """Take temperatures that vary in other ways in space; collective.

        Args:
            heated: All groups, of the same extents.

        Raises:
            InputError: A function or a file of a temperature fails; the body is of no use then.
        """
        for part in self.heated:
            extent = part.described.extent
            part.take_field(next(each for each in heated if each.extent == extent))
        self._renew_heated()

    def _renew_heated(self) -> None:
        """Find what parts with other temperatures do to the body; collective."""
        self._renew_parts(len(self.preloaded))

    def _renew_parts(self, first: int) -> None:
        """Find what parts do to the body from this one on, preloaded ones first; collective."""
        for number in range(first, len(self._parts)):
            forces = self._forms_of_parts[number].assembled()
            self.scalar_forces[number] = forces
            self.scalar_stiffness[number, number] = forces.stiffness
        for tight in self.scalar_forces[:first]:
            tight.others.clear()
        self._couple_parts()
        self._renew_ways()

    def _renew_ways(self) -> None:
        """Find what parts with other temperatures do in the motions of faces; collective."""
        own, parts = slice(self._spaces.owned_nodes), self.scalar_forces[: len(self._parts)]
        first = len(self.scalar_forces) - len(self._ways)
        for column, way in enumerate(self._ways, first):
            works = np.array([np.sum(part.nodal[own] * way.moved[own]) for part in parts])
            works = np.asarray(total(self._spaces.comm, works))
            self.scalar_stiffness[: len(parts), column] = works
            self.scalar_stiffness[column, : len(parts)] = works
            way.others.clear()
            way.follow(self.scalar_forces[:first], self.scalar_stiffness[:first, column])

    @property
    def forces_of_heated(self) -> list[ScalarForces]:
        """Forces on the body by a unit of the thermal expansion of each heated part."""
        first = len(self.preloaded)
        return self.forces_of_parts[first:]

    @property
    def forces_of_parts(self) -> list[ScalarForces]:
        """Forces on the body by a unit of the scalar of each preloaded, then heated part."""
        return self.scalar_forces[: len(self._parts)]

    @property
    def has_free_strains(self) -> bool:
        """Whether parts have a strain that is free of stress."""
        return bool(self._parts)

    @property
    def columns(self) -> ScalarColumns:
        """Columns of the scalars in the equations of statics."""
        forces = self.scalar_forces
        nodal, stresses = [one.nodal for one in forces], [one.on_mean_stress for one in forces]
        return ScalarColumns(nodal, stresses, self.scalar_stiffness)

    @property
    def of_points(self) -> list[ScalarForces]:
        """Forces on the body by units of the motions and of the forces of coupled points."""
        return self.scalar_forces[len(self._parts) :]

    def _place_preloads(self, description: BodyDescription) -> list[PreloadedPart]:
        """The preloaded parts, which share no cells; collective."""
        spaces = self._spaces
        found: list[PreloadedPart] = []
        for number, described in enumerate(description.preloads):
            part = PreloadedPart(described, f"preload[{number}]", spaces, self.law)
            cells = spaces.body.entities(part.group)
            for other in found:
                shared = np.intersect1d(cells, spaces.body.entities(other.group))
                if total(spaces.comm, len(shared)) > 0:
                    raise InputError(
                        f"preload[{number}].on = '{described.on}': shares cells with the preload "
                        f"'{other.described.label}'"
                    )
            found.append(part)
        return found

    def _place_temperatures(self, description: BodyDescription) -> list[HeatedPart]:
        """The parts that have a temperature, which share no cells; collective."""
        spaces = self._spaces
        found: list[HeatedPart] = []
        for described in description.heated:
            part = HeatedPart(described, description.material, spaces, self.law)
            if not part.is_there:
                continue
            key = f"temperature[{described.table}]"
            if not described.axes:
                several = f"[{described.material}]" if len(description.material) > 1 else ""
                raise InputError(f"material{several}.thermal_expansion is missing: {key} heats it")
            for other in found:
                if total(spaces.comm, len(np.intersect1d(part.cells, other.cells))) > 0:
                    raise InputError(
                        f"{key}.on = '{described.on}': shares cells with "
                        f"temperature[{other.described.table}]"
                    )
            found.append(part)
        return found

    def _forms_of(self, part: PreloadedPart | HeatedPart) -> ScalarForms:
        """Slopes of the energy in a part, of the strain that is elastic."""
        scalar = ufl.variable(part.scalar)
        e = self.strain(self.displacement) - part.stressless_strain(scalar)
        if self.mixed is None:
            density = 0.5 * ufl.inner(self.law.stress(e), e)
            mean_stress = None
        else:
            assert isinstance(self.law, Isotropic)
            mean_stress = self.mixed.mean_stress
            density = 0.5 * ufl.inner(self.law.deviatoric_stress(e), e) + mean_stress * ufl.tr(e)
        energy = self._spaces.weight * density, part.measure, scalar
        known = self._spaces, part.scalar
        return ScalarForms.of(*known, energy, self.displacement, mean_stress)

    def moduli_behind(self, nodes: NDArray[np.int32]) -> Moduli:
        """Moduli of the stiffest of the parts that nodes of this rank belong to; collective."""
        parts = self._spaces.parts
        present = np.zeros(parts.count)
        present[parts.of_node[nodes]] = 1.0
        reached = np.flatnonzero(total(self._spaces.comm, present))
        return max((self._moduli[part] for part in reached), key=lambda found: found.reference)

    @property
    def forms(self) -> tuple[fem.Form, ...]:
        """All compiled forms."""
        if self.mixed is None:
            return (self.stiffness,)
        mixed = self.mixed
        return (self.stiffness, mixed.gradient, mixed.divergence, mixed.compressibility)

    def strain(self, displacement: Expr) -> Expr:
        """Strain of a displacement, shape (3, 3)."""
        spaces = self._spaces
        return strain(displacement, spaces.kinematics, spaces.position, self.law)

    def total_strain(self) -> Expr:
        """Strain of the solution as a UFL expression, shape (3, 3).

        In plane stress it has across the plane what stress, and what heat, makes there.
        """
        found = self.strain(self.displacement)
        if self._spaces.kinematics != "plane stress" or not self.has_free_strains:
            return found
        across = self.elastic_strain(self.displacement)[2, 2]
        across += sum(part.strain_across for part in self.heated)
        (xx, xy), (yx, yy) = ((found[i, 0], found[i, 1]) for i in (0, 1))
        return ufl.as_tensor([[xx, xy, 0], [yx, yy, 0], [0, 0, across]])

    def elastic_strain(self, displacement: Expr) -> Expr:
        """Strain of a displacement less what is free of stress at present, shape (3, 3).

        To be taken for what the body is at, not for variations of that.
        """
        found = self.strain(displacement)
        for part in self._parts:
            found -= part.present_strain
        return found

    def heat_strain(self, rise: Expr) -> Expr | None:
        """Strain free of stress of a rise, less the present one of temperatures found, (3, 3).

        Of the rise in full, where the present one is of its projection.

        Args:
            rise: Temperature less the reference, in UFL (temperature).

        Returns:
            None where no temperature is found that expands anything.
        """
        parts = [part for part in self.heated if part.described.is_found]
        return sum(part.strain_beyond(rise) for part in parts) if parts else None

    def heat_stress(self, rise: Expr) -> Expr | None:
        """Stress by that strain where nothing moves, (3, 3): the negative of what it would take."""
        strain = self.heat_strain(rise)
        return None if strain is None else -self._stress_of(strain)

    def virtual_work(
        self, law: Law, state: tuple[Expr, Expr | None], virtual: tuple[Expr, Expr | None]
    ) -> Expr:
        """Virtual work of the body's stresses over volume, weighted: the stiffness's density.

        Args:
            law: In place of the body's own, such as one with variables for moduli.
            state: Displacement (length), and mean stress where that is an unknown (stress).
            virtual: The same of what it works on.
        """
        spaces, (u, s), (v, t) = self._spaces, state, virtual
        e, f = (strain(one, spaces.kinematics, spaces.position, law) for one in (u, v))
        if self.mixed is None:
            return spaces.weight * ufl.inner(law.stress(e), f)
        assert isinstance(law, Isotropic) and s is not None and t is not None
        found = ufl.inner(law.deviatoric_stress(e), f) + s * ufl.tr(f) + t * ufl.tr(e)
        found -= s * t / law.bulk_modulus
        if self._is_stabilised:
            difference = _cell_covariance(spaces.body.mesh, s, t)
            found -= difference / law.shear_modulus
        return spaces.weight * found

    @property
    def _is_stabilised(self) -> bool:
        """Whether a mean stress differs from its mean in each cell at a cost."""
        return not compat.is_tensor_cell(self._spaces.body.mesh) and self._spaces.degree == 1

    def stress(self) -> Expr:
        """Cauchy stress of the solution as a UFL expression, shape (3, 3)."""
        e = self.elastic_strain(self.displacement)
        if self.mixed is None:
            return self.law.stress(e)
        assert isinstance(self.law, Isotropic)
        return self.law.deviatoric_stress(e) + self.mixed.mean_stress * ufl.Identity(3)

    def nominal_stress(self, displacement: Expr | None = None) -> Expr:
        """Stress by which forces over undeformed areas are found, shape (3, 3).

        Args:
            displacement: Of a state without mean stress; by default of the solution.
        """
        if displacement is None or self.mixed is not None:
            return self.stress()
        return self.law.stress(self.elastic_strain(displacement))

    def displacement_stress(self, displacement: Expr) -> Expr:
        """The stress that a displacement makes, shape (3, 3): where mixed, its deviatoric part."""
        return self._stress_of(self.strain(displacement))

    def _stress_of(self, strain: Expr) -> Expr:
        """The stress of a strain, shape (3, 3): where mixed, its deviatoric part."""
        if self.mixed is None:
            return self.law.stress(strain)
        assert isinstance(self.law, Isotropic)
        return self.law.deviatoric_stress(strain)

    def _mixed_forms(self, law: Isotropic, several: bool) -> MixedForms:
        spaces = self._spaces
        tensor = compat.is_tensor_cell(spaces.body.mesh)
        family = {1: ("DG", 0), 2: ("DPC", 1)}[spaces.degree] if tensor else ("Lagrange", 1)
        if several and not tensor and spaces.degree == 2:
            family = ("DG", 0)  # the mean stress jumps from one material to the next
        space = fem.functionspace(spaces.body.mesh, family)
        s, t = ufl.TrialFunction(space), ufl.TestFunction(space)
        u = ufl.TrialFunction(spaces.displacement_space)
        v = ufl.TestFunction(spaces.displacement_space)
        weight, bulk = spaces.weight, spaces.bulk
        compressibility = weight / law.bulk_modulus * s * t * bulk
        if self._is_stabilised:
            difference = _cell_covariance(spaces.body.mesh, s, t)
            compressibility += weight / law.shear_modulus * difference * bulk
        return MixedForms(
            gradient=form_cache.form(weight * s * ufl.tr(self.strain(v)) * bulk),
            divergence=form_cache.form(weight * t * ufl.tr(self.strain(u)) * bulk),
            compressibility=form_cache.form(compressibility),
            mean_stress=fem.Function(space, name="mean_stress"),
        )


def _cell_covariance(mesh: Mesh, s: Expr, t: Expr) -> Expr:
    """Mean of (s − Πs)(t − Πt) over a simplex, s and t linear and Π the mean of the cell.

    By the covariance of the reference simplex's coordinates: constants drop out exactly,
    whatever the weight, so a uniform mean stress is left alone.
    """
    dimension = mesh.topology.dim
    scale = (dimension + 1) ** 2 * (dimension + 2)
    covariance = ((dimension + 1) * np.eye(dimension) - np.ones((dimension, dimension))) / scale
    jacobian = ufl.Jacobian(mesh)
    slopes = [jacobian.T * ufl.grad(function) for function in (s, t)]
    return ufl.dot(slopes[0], ufl.dot(ufl.as_matrix(covariance.tolist()), slopes[1]))


class ModulusSlopes:
    """ψ · K_θ u of a modulus θ of a material; collective.

    Args:
        elastic: The body, of isotropic materials.
        spaces: Those of it.
    """

    def __init__(self, elastic: ElasticBody, spaces: Spaces) -> None:
        self._elastic, self._spaces = elastic, spaces
        self._state, self._virtual = self._functions(), self._functions()
        self._forms: dict[tuple[str, str], fem.Form] = {}

    def _functions(self) -> tuple[fem.Function, fem.Function | None]:
        """Displacement, and mean stress where that is an unknown."""
        mixed = self._elastic.mixed
        stress = None if mixed is None else fem.Function(mixed.mean_stress.function_space)
        return fem.Function(self._spaces.displacement_space), stress

    def work(
        self, name: str, on: str, state: tuple[Array, Array], virtual: tuple[Array, Array]
    ) -> float:
        """This rank's part of ψ · K_θ u.

        Args:
            name: ``youngs_modulus`` or ``poissons_ratio``.
            on: Group of cells of the material, empty where it fills the body.
            state: u at the nodes of this rank, (nodes, components), and its mean stress at the dofs
                of this rank, empty without one.
            virtual: The same of ψ.
        """
        if (name, on) not in self._forms:
            self._forms[name, on] = form_cache.form(self._work(name, on))
        for functions, values in ((self._state, state), (self._virtual, virtual)):
            for function, array in zip(functions, values, strict=True):
                if function is not None:
                    function.x.array[:] = array.reshape(-1)
        return float(np.real(fem.assemble_scalar(self._forms[name, on])))

    def _work(self, name: str, on: str) -> Any:
        law, spaces = self._elastic.law, self._spaces
        assert isinstance(law, Isotropic)
        free = Isotropic(ufl.variable(law.youngs_modulus), ufl.variable(law.poissons_ratio))
        density = self._elastic.virtual_work(free, self._state, self._virtual)
        rule = {"quadrature_degree": spaces.bulk_degree}
        group = spaces.body.group(on, "material.on") if on else None
        measure = spaces.bulk if group is None else spaces.part(group, rule)
        return ufl.diff(density, getattr(free, name)) * measure
