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


def angle(x):
    return np.arctan2(x[1], x[0])


def waves(x):
    """Pressure that is the same in all sectors, and in none of them symmetric."""
    return 0.2 * (1 + 0.5 * np.cos(SECTORS * angle(x) + 0.7))


def around(traction, dimension=2):
    """Traction around the axis, by its components."""
    found = (lambda x: -traction * np.sin(angle(x)), lambda x: traction * np.cos(angle(x)))
    return (*found, 0.0)[:dimension]


def hub_on_shaft(copies, cells=((4, 2), (4, 3)), dimension=2, cell="", order=1):
    """``cut0`` and ``cut1`` are the faces of the cut through both bodies, which are skew.

    Args:
        copies: Of the sector.
        cells: Around a sector and along the radius, of the shaft and of the hub.
        dimension: Of the bodies, 3 long in space.
        cell: Kind of the cells, by default quadrilaterals or hexahedra.
        order: Of the cells' geometry; those of order 1 are in waves.
    """
    low, high, more = ((0.0,), (3.0,), (1,)) if dimension == 3 else ((), (), ())
    turn = 2 * np.pi * copies / SECTORS
    (shaft, inner), (hub, outer) = cells
    parts = (
        Box("shaft", (0.0, BORE, *low), (turn, SEAT, *high), (shaft * copies, inner, *more)),
        Box("hub", (0.0, SEAT, *low), (turn, RIM, *high), (hub * copies, outer, *more)),
    )
    closed = ("shaft", "hub") if copies == SECTORS else ()
    kind = cell or ("quadrilateral" if dimension == 2 else "hexahedron")
    body = boxes(parts, kind, order=order, closed=closed)
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
