"""Rows of the table of quantities."""

from __future__ import annotations

from fenics_contact.quantities import names
from fenics_contact.quantities.quantity import Edge, Quantity, Singular, Together

#: In the order in which they are shown.
ROWS = (
    Quantity(
        names.NORMAL_FORCE,
        "force",
        "resultant of the contact pressure along the axis of the contact, > 0 when it pushes. "
        "The axis is that along which an obstacle is driven, by default its normal. Where "
        "there is no obstacle, or one that has neither a shape nor a direction, the axis is "
        "the mean normal of the whole surface `on`, touching or not; between bodies it is the "
        "mean normal of `on` less that of `against`. Components across planes of symmetry "
        "that the surface ends in, and the radius of an axisymmetric model, are left out of "
        "it. `null` where that mean normal is shorter than .5: the surface wraps around, and "
        "no one direction stands for it",
        together=Together.OF_THE_ONLY,
        is_asked_for=True,
        instead=names.PRESSURE_INTEGRAL,
        singular=Singular.RESULTANT,
        no_value="none, the surface wraps around",
    ),
    Quantity(
        names.PRESSURE_INTEGRAL,
        "force",
        "∫ p dA, also where `normal_force` is `null`. On a flat surface the two are equal; on "
        "a curved one the integral is larger",
        together=Together.OF_THE_ONLY,
        is_asked_for=True,
        singular=Singular.RESULTANT,
        is_secondary=True,
    ),
    Quantity(
        names.FRICTION_FORCE,
        "force",
        "resultant of the friction traction, a vector. On a curved surface it has a part "
        "along the axis",
        together=Together.OF_THE_ONLY,
        is_vector=True,
        is_asked_for=True,
        relative_to=names.NORMAL_FORCE,
        singular=Singular.RESULTANT,
        needs="friction",
    ),
    Quantity(
        names.CONTACT_FORCE,
        "force",
        "resultant of pressure and friction together, a vector: what loads, other contacts "
        "and supports balance",
        together=Together.OF_THE_ONLY,
        is_vector=True,
        is_asked_for=True,
        singular=Singular.RESULTANT,
        is_secondary=True,
    ),
    Quantity(
        names.REACTION,
        "force",
        "resultant of all supports on the bodies, a vector; each support's own is under `supports`",
        is_vector=True,
        is_asked_for=True,
    ),
    Quantity(
        names.REACTION_MOMENT,
        "force·length",
        "moment of the reaction of the supports of one name on the bodies, about `moment_about`, "
        "by default the centroid of `on`: in space a vector, in plane models a number; not in "
        "axisymmetric models. It is under `supports` and `reactions`, and not among `quantities`",
        is_vector=True,
        is_moment=True,
    ),
    Quantity(
        names.INDENTATION,
        "length",
        "how far a rigid obstacle has been driven, where there is one",
        together=Together.OF_THE_ONE,
        is_of_some=True,
        is_asked_for=True,
        needs="contact found",
    ),
    Quantity(
        names.MAX_CONTACT_PRESSURE,
        "stress",
        "the largest pressure at a contact point; on quadratic triangles that of the function "
        "on the facets which is nearest to the pressures at the points and has the same "
        "forces",
        together=Together.LARGEST,
        is_asked_for=True,
        is_local=True,
        singular=Singular.PEAK,
    ),
    Quantity(
        names.MAX_PENETRATION,
        "length",
        "the deepest overlap that the penalty leaves, or the depth in a foundation",
        together=Together.LARGEST,
        is_local=True,
        singular=Singular.PEAK,
        needs="contact found",
    ),
    Quantity(
        names.CONTACT_AREA,
        "area",
        "area in contact; its edge is found inside the elements",
        together=Together.SUM,
        is_asked_for=True,
        edges=(Edge.CONTACT,),
        is_local=True,
    ),
    Quantity(
        names.STICK_AREA,
        "area",
        "the part of it that sticks",
        together=Together.SUM,
        is_asked_for=True,
        relative_to=names.CONTACT_AREA,
        edges=(Edge.STICK,),
        is_local=True,
        needs="friction",
    ),
    Quantity(
        names.SLIP_AREA,
        "area",
        "the part of it that slips. Without friction all of it slips",
        together=Together.SUM,
        is_asked_for=True,
        relative_to=names.CONTACT_AREA,
        edges=(Edge.CONTACT, Edge.STICK),
        is_local=True,
        needs="friction",
    ),
    Quantity(
        names.CONTACT_RADIUS,
        "length",
        "in axisymmetric models, of a surface that reaches the axis: radius of the disc that "
        "touches around the axis. 0 where nothing touches; `null` where something touches, "
        "but not at the axis",
        together=Together.OF_THE_ONE,
        is_of_some=True,
        is_asked_for=True,
        edges=(Edge.CONTACT,),
        is_local=True,
        no_value="none, no contact at the axis",
    ),
    Quantity(
        names.STICK_RADIUS,
        "length",
        "likewise, of the disc that sticks",
        together=Together.OF_THE_ONE,
        is_of_some=True,
        is_asked_for=True,
        relative_to=names.CONTACT_RADIUS,
        edges=(Edge.STICK,),
        is_local=True,
        needs="friction",
        no_value="none, no stick at the axis",
    ),
    Quantity(
        names.MAX_SLIP,
        "length",
        "the largest slip since the start **of points that touch** at the end; 0 where none "
        "touches. Open points have no slip to speak of, whatever `contact.csv` says of their "
        "motion",
        together=Together.LARGEST,
        is_asked_for=True,
        is_local=True,
        needs="friction",
    ),
    Quantity(
        names.STRAIN_ENERGY,
        "energy",
        "½ a(u, u); in finite strains ∫ Ψ(F) of the stored energy Ψ",
        is_asked_for=True,
        singular=Singular.ENERGY,
    ),
    Quantity(
        names.SPRING_ENERGY,
        "energy",
        "in the springs of elastic supports (`support.stiffness`), where there are some; no part "
        "of `strain_energy`",
        singular=Singular.ENERGY,
    ),
    Quantity(
        names.EXTERNAL_WORK,
        "energy",
        "work of loads, supports, obstacles, preloads and interferences along the load steps; "
        "of a single step that of the final forces on the final displacements, which is twice "
        "the strain energy, with that of springs, where all grows in proportion. An interference "
        "does work on its way beyond a gap that is drawn",
        is_asked_for=True,
        singular=Singular.ENERGY,
        is_secondary=True,
    ),
    Quantity(
        names.FRICTION_WORK,
        "energy",
        "dissipated by friction since the start, ≥ 0; where friction has micro-slip, less "
        "what rising pressures add to `elastic_slip_energy`, which can make it negative",
        together=Together.SUM,
        is_asked_for=True,
        relative_to=names.STRAIN_ENERGY,
        needs="friction",
    ),
    Quantity(
        names.WORN_VOLUME,
        "volume",
        "what both surfaces together have lost by wear since the start",
        together=Together.SUM,
        is_of_some=True,
    ),
    Quantity(
        names.MAX_WEAR_DEPTH,
        "length",
        "the deepest wear at a contact point, of both surfaces together",
        together=Together.LARGEST,
        is_of_some=True,
    ),
    Quantity(
        names.WORN_VOLUME_ON,
        "volume",
        "the part of `worn_volume` that the surface `on` has lost, where `wear.share` says it",
        together=Together.SUM,
        is_of_some=True,
    ),
    Quantity(
        names.WORN_VOLUME_AGAINST,
        "volume",
        "likewise of the surface `against`",
        together=Together.SUM,
        is_of_some=True,
    ),
    Quantity(
        names.MAX_WEAR_DEPTH_ON,
        "length",
        "the part of `max_wear_depth` that the surface `on` has lost, likewise",
        together=Together.LARGEST,
        is_of_some=True,
    ),
    Quantity(
        names.MAX_WEAR_DEPTH_AGAINST,
        "length",
        "likewise of the surface `against`",
        together=Together.LARGEST,
        is_of_some=True,
    ),
    Quantity(
        names.PENALTY_ENERGY,
        "energy",
        "in the springs of penalty, foundation or glue",
        together=Together.SUM,
        is_asked_for=True,
        singular=Singular.PEAK,
        is_secondary=True,
    ),
    Quantity(
        names.ELASTIC_SLIP_ENERGY,
        "energy",
        "stored along surfaces whose friction has micro-slip, in the slip that goes back",
        together=Together.SUM,
        is_of_some=True,
        needs="friction",
    ),
    Quantity(
        names.KINETIC_ENERGY,
        "energy",
        "½ v · M v, where bodies move (`[motion]`)",
    ),
    Quantity(
        names.LEFT_OUT_KINETIC_ENERGY,
        "energy",
        "of what gives way beside the modes of `motion.modes`, which take it for none",
    ),
    Quantity(
        names.DAMPING_WORK,
        "energy",
        "what `motion.rayleigh` and `motion.absorbing` took since the start",
    ),
    Quantity(
        names.MOMENTUM,
        "impulse",
        "of all that moves, a vector; of a revolution its part along the axis",
        is_vector=True,
    ),
    Quantity(
        names.IMPULSE,
        "impulse",
        "∫ `contact_force` dt since the start, a vector, where bodies move",
        together=Together.OF_THE_ONE,
        is_of_some=True,
        is_vector=True,
    ),
    Quantity(
        names.ENERGY_DEFECT,
        "energy",
        "what the load steps leave open of the balance of work and energies; not of a single step",
        has_true_value=False,
    ),
    Quantity(
        f"{names.OF_POINTS}NAME",
        "length",
        "at each `[[point]]`, a vector",
        is_vector=True,
        is_asked_for=True,
    ),
    Quantity(
        f"{names.STRESS_OF_POINTS}NAME",
        "stress",
        "at each `[[point]]`, by component: `stress_NAME_xx`, `_yy`, `_zz`, `_xy`, in space also "
        "`_yz` and `_xz`. It is the mean over the cells of one material around each node, linear "
        "or quadratic between the nodes as the displacement; on a face between two materials the "
        "mean of both. It has no error bar",
    ),
    Quantity(
        f"{names.STRAIN_OF_POINTS}NAME",
        "",
        "at each `[[point]]`, by component as the stress: `strain_NAME_xx`, `_yy`, …, of all that "
        "strains the body, heat too; `_xy` is half of the change of the angle. It has no error bar",
    ),
    Quantity(
        f"{names.TEMPERATURE_OF_POINTS}NAME",
        "temperature",
        "at each `[[point]]`, where the scene has temperatures, as it gives them; where conduction "
        "finds them with an error bar",
        has_true_value=False,
    ),
    Quantity(
        names.MAX_TEMPERATURE,
        "temperature",
        "the highest of all nodes, where the scene has temperatures; where conduction finds them "
        "with an error bar, which counts what lies between the nodes",
        has_true_value=False,
    ),
    Quantity(
        names.CONTACT_MOMENT,
        "force·length",
        "in space: moment of pressure and friction together on the body of `on`, a vector, about "
        "`moment_about`, by default the centroid of the surface `on`, touching or not",
        together=Together.OF_THE_ONE,
        is_of_some=True,
        is_vector=True,
        singular=Singular.RESULTANT,
        is_secondary=True,
    ),
    Quantity(
        names.TORQUE,
        "force·length",
        "the part of that moment about the `axis` of the contact; in plane models with "
        "`moment_about` the moment about the axis across the plane",
        together=Together.OF_THE_ONE,
        is_of_some=True,
        is_asked_for=True,
        singular=Singular.RESULTANT,
    ),
    Quantity(
        names.HEAT_FLOW,
        "power",
        "that crosses a contact with a `conductance` into the body of `on`",
        together=Together.OF_THE_ONE,
        is_of_some=True,
        is_asked_for=True,
    ),
    Quantity(
        names.OBSTACLE_DISPLACEMENT,
        "length",
        "how far an obstacle has been moved besides, a vector, where the scene moves it",
        together=Together.NOT_THERE,
        has_true_value=False,
    ),
    Quantity(
        names.OBSTACLE_ROTATION,
        "",
        "by which angle an obstacle has turned about the axis of its `rotation`, in radian, given "
        "or found under a moment, where it turns",
        together=Together.OF_THE_ONE,
        is_of_some=True,
        is_asked_for=True,
        needs="contact found",
    ),
    Quantity(
        names.SLIP_SHARE,
        "",
        "with friction: how much of what it can hold against rigid slip of one side along the "
        "other it does hold, 0 … 1: the largest ∫ τ · r dA / ∫ g |r| dA of rigid motions r "
        "along all that touches, with the traction τ and its bound g; of a torque, too. "
        "`null` where no rigid motion slips along all that touches, as of a key, or of a cone "
        "that has no rotation",
        together=Together.NOT_THERE,
        has_true_value=False,
        no_value="-",
    ),
    Quantity(
        names.SLIP_FACTOR,
        "",
        "factor of the loads that vary in the last load step at which a part that friction holds "
        "slips as a whole (`slip_limit.factor`); left out where it is not known, and of an upper "
        "bound",
    ),
    Quantity(
        names.UNDECIDED_POINTS,
        "",
        "with friction: how many points slip by less than 2ε",
        together=Together.NOT_THERE,
        has_true_value=False,
    ),
    Quantity(
        names.SLIP_SINCE_PAIRING,
        "",
        "between bodies: largest slip of points that touch since it was found what faces "
        "what, over the size of the contact",
        together=Together.NOT_THERE,
        has_true_value=False,
    ),
    Quantity(
        names.CLOSED_GAP,
        "length",
        "between bodies: the widest gap of the meshes that has closed",
        together=Together.NOT_THERE,
        has_true_value=False,
    ),
    Quantity(
        names.MIN_VOLUME_RATIO,
        "",
        "in finite strains: least volume over undeformed volume, det F, at the points where the "
        "energy is integrated",
        singular=Singular.PEAK,
    ),
    Quantity(
        names.MAX_STRETCH,
        "",
        "in finite strains: largest length over undeformed length, at the same points",
        singular=Singular.PEAK,
    ),
    Quantity(
        names.MIN_STRETCH,
        "",
        "in finite strains: smallest one in the plane",
        singular=Singular.PEAK,
    ),
)
