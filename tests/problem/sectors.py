"""A hub on a shaft, whole or one sector of it, on meshes that are copies of each other."""

import dataclasses

import numpy as np
from mpi4py import MPI

from fenics_contact import (
    Contact,
    CyclicSymmetry,
    Group,
    Load,
    Material,
    Run,
    Scene,
    SolverSettings,
    Support,
)
from fenics_contact.verification.boxes import Box, boxes

COMM = MPI.COMM_WORLD
SECTORS, FIT = 12, 0.02
BORE, SEAT, RIM = 5.0, 10.0, 20.0
_SIDES = ("x0", "x1", "y0", "y1")


def angle(x):
    return np.arctan2(x[1], x[0])


def waves(x):
    """Pressure that is the same in all sectors, and in none of them symmetric."""
    return 0.2 * (1 + 0.5 * np.cos(SECTORS * angle(x) + 0.7))


def around(traction, dimension=2):
    """Traction around the axis, by its components."""
    found = (lambda x: -traction * np.sin(angle(x)), lambda x: traction * np.cos(angle(x)))
    return (*found, 0.0)[:dimension]


def hub_on_shaft(
    copies, cells=((4, 2), (4, 3)), dimension=2, cell="", order=1, offset=0.0, comm=COMM
):
    """``cut0`` and ``cut1`` are the faces of the cut through both bodies, which are skew.

    Args:
        copies: Of the sector.
        cells: Around a sector and along the radius, of the shaft and of the hub.
        dimension: Of the bodies, 3 long in space.
        cell: Kind of the cells, by default quadrilaterals or hexahedra.
        order: Of the cells' geometry; those of order 1 are in waves.
        offset: Of the hub's cut against that of the shaft, in sectors.
        comm: Of the mesh.
    """
    low, high, more = ((0.0,), (3.0,), (1,)) if dimension == 3 else ((), (), ())
    turn, ahead = 2 * np.pi * copies / SECTORS, 2 * np.pi * offset / SECTORS
    (shaft, inner), (hub, outer) = cells
    parts = (
        Box("shaft", (0.0, BORE, *low), (turn, SEAT, *high), (shaft * copies, inner, *more)),
        Box("hub", (ahead, SEAT, *low), (ahead + turn, RIM, *high), (hub * copies, outer, *more)),
    )
    closed = ("shaft", "hub") if copies == SECTORS else ()
    kind = cell or ("quadrilateral" if dimension == 2 else "hexahedron")
    body = boxes(parts, kind, order=order, closed=closed, comm=comm)
    wave = 1.0 if order == 1 else 0.0
    x = body.mesh.geometry.x
    turned, radius = x[:, 0].copy(), x[:, 1].copy()
    middle = np.abs(np.sin(np.pi * (radius - SEAT) / (RIM - SEAT)))
    middle = np.where(radius < SEAT, np.abs(np.sin(np.pi * (radius - BORE) / BORE)), middle)
    radius += 0.3 * wave * middle * np.sin(SECTORS * turned + 1)
    turned += wave * (0.03 * np.sin(SECTORS * turned) + 0.02 * (radius - SEAT) / SEAT)
    x[:, 0], x[:, 1] = radius * np.cos(turned), radius * np.sin(turned)
    if closed:
        return body
    groups = {
        f"cut{end}": Group(
            dimension - 1,
            tuple(tag for name in ("shaft", "hub") for tag in body.groups[f"{name}.x{end}"].tags),
        )
        for end in (0, 1)
    }
    return dataclasses.replace(body, groups={**body.groups, **groups})


def _polar(body):
    """Places given by angle and radius, in the plane."""
    x = body.mesh.geometry.x
    turned, radius = x[:, 0].copy(), x[:, 1].copy()
    x[:, 0], x[:, 1] = radius * np.cos(turned), radius * np.sin(turned)


def _joined(body, **names):
    """The body with further groups, each of several others."""
    groups = {
        name: Group(1, tuple(tag for one in members for tag in body.groups[one].tags))
        for name, members in names.items()
    }
    return dataclasses.replace(body, groups={**body.groups, **groups})


def _disc(copies):
    turn = 2 * np.pi * copies / SECTORS
    return Box("disc", (0.0, BORE), (turn, SEAT), (4 * copies, 2))


def teeth_on_disc(copies):
    """Each tooth as wide as a sector: its sides ``teeth.x0`` and ``.x1`` touch those beside it."""
    turn = 2 * np.pi / SECTORS
    teeth = [
        Box(f"tooth{k}", (k * turn, SEAT), ((k + 1) * turn, RIM), (4, 3)) for k in range(copies)
    ]
    closed = ("disc",) if copies == SECTORS else ()
    body = boxes([_disc(copies), *teeth], closed=closed)
    _polar(body)
    sides = {f"teeth.{side}": [f"{tooth.name}.{side}" for tooth in teeth] for side in _SIDES}
    return _joined(body, **sides)


def blocks_on_disc(copies, layers=(3, 3)):
    """Blocks where the cut is, which parts each of them: ``cut0`` and ``cut1`` are its faces.

    Args:
        copies: Of the sector.
        layers: Of cells in both pieces of a block.
    """
    turn = 2 * np.pi / SECTORS
    if copies == SECTORS:
        ends = [(k * turn - turn / 3, k * turn + turn / 3, 6) for k in range(copies)]
    else:
        ends = [(0.0, turn / 3, 3), (2 * turn / 3, turn, 3)]
    blocks = [
        Box(f"block{k}", (low, SEAT), (high, 15.0), (cells, layers[k % 2]))
        for k, (low, high, cells) in enumerate(ends)
    ]
    closed = ("disc",) if copies == SECTORS else ()
    body = boxes([_disc(copies), *blocks], closed=closed)
    _polar(body)
    sides = {f"blocks.{side}": [f"{block.name}.{side}" for block in blocks] for side in _SIDES}
    if not closed:
        sides |= {"cut0": ["disc.x0", "block0.x0"], "cut1": ["disc.x1", "block1.x1"]}
    return _joined(body, **sides)


def on_disc(whole, kind, solver="condensed", **contact):
    """Teeth glued on a disc, or blocks that lie on it, pressed from outside and pushed around."""
    given = {"law": "static", "friction_coefficient": 0.3} | contact
    contacts = [Contact("blocks.y0", against="disc.y1", **given)]
    if kind == "teeth":
        glue = Contact("teeth.y0", against="disc.y1", contact="bonded")
        contacts = [glue, Contact("teeth.x1", against="teeth.x0", **given)]
    cut = ("disc.x0", "disc.x1") if kind == "teeth" else ("cut0", "cut1")
    return Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("disc.y0", {"x": 0, "y": 0}),),
        load=(
            Load(f"{kind}.y1", pressure=waves),
            Load(f"{kind}.y1", traction=around(0.01)),
        ),
        contact=tuple(contacts),
        solver=SolverSettings(solver=solver),
        cyclic_symmetry=None if whole else CyclicSymmetry(*cut, SECTORS),
    )


def fitted(whole, dimension=2, solver="condensed", twist=0.02, errors="none", **contact):
    """The hub is too tight, pressed from outside and twisted; the shaft is held at its bore."""
    loads = [Load("hub.y1", pressure=waves)]
    loads += [Load("hub.y1", traction=around(twist, dimension))] if twist else []
    supports = [Support("shaft.y0", dict.fromkeys("xyz"[:dimension], 0.0))]
    supports += [Support("hub.z0", {"z": 0})] if dimension == 3 else []
    given = {"law": "static", "friction_coefficient": 0.3, "interference": FIT} | contact
    axis = (0, 0, 2) if dimension == 3 else None
    return Scene(
        kinematics="plane strain" if dimension == 2 else "3D",
        material=Material(1000, 0.3),
        support=tuple(supports),
        load=tuple(loads),
        contact=(Contact("hub.y0", against="shaft.y1", **given),),
        solver=SolverSettings(solver=solver, errors=errors),
        cyclic_symmetry=None if whole else CyclicSymmetry("cut0", "cut1", SECTORS, axis),
    )


def sector(mesh=None, **scene):
    """A run of one sector that is not solved yet.

    Args:
        mesh: As of ``hub_on_shaft``.
        scene: As of ``fitted``.
    """
    return Run(fitted(False, **scene), COMM, hub_on_shaft(1, **(mesh or {})))
