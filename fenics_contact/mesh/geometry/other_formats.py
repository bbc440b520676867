"""Files of other programs that are not read: what to make of them instead."""

from __future__ import annotations

import shlex

_CAD = "save the part as STEP (.step) in the CAD program"
_NO_SOLID = (
    "it has triangles of a surface and no solid: save the part as STEP (.step) in the CAD program"
)
_MESHIO = "convert it to .msh by meshio (`meshio convert {name} {mesh}`), groups and all"
_GMSH = "open it in Gmsh and save it as .msh"
_ANSYS = "save its mesh as .vtk by ansys-mapdl-reader, and convert that to .msh by meshio"
_HYPERMESH = "export its mesh for Nastran or Abaqus, and convert that to .msh by meshio"
_DRAWING = "a drawing is no body: save the part as STEP (.step) in the CAD program"
_SHAPE = "save it as STEP (.step), for instance in FreeCAD"

_WAYS = {
    **dict.fromkeys((".sldprt", ".sldasm"), _CAD),  # SolidWorks
    **dict.fromkeys((".ipt", ".iam"), _CAD),  # Inventor
    **dict.fromkeys((".catpart", ".catproduct", ".cgr", ".3dxml"), _CAD),  # CATIA
    **dict.fromkeys((".x_t", ".x_b", ".xmt_txt", ".xmt_bin", ".sat", ".sab", ".jt"), _CAD),
    **dict.fromkeys((".prt", ".asm", ".par", ".psm", ".f3d", ".fcstd", ".3dm", ".skp"), _CAD),
    **dict.fromkeys((".scdoc", ".scdocx", ".agdb", ".neu", ".cae"), _CAD),
    **dict.fromkeys((".dwg", ".dxf", ".svg", ".pdf"), _DRAWING),
    **dict.fromkeys((".stl", ".obj", ".ply", ".off", ".3mf", ".amf", ".wrl"), _NO_SOLID),
    **dict.fromkeys((".igs", ".iges"), _SHAPE),
    ".brp": "rename it to {stem}.brep, which is the same",
    **dict.fromkeys((".cdb", ".rst"), _ANSYS),
    **dict.fromkeys((".hm", ".hmascii"), _HYPERMESH),
    **dict.fromkeys((".vtk", ".e", ".ex2", ".exo", ".vol", ".mesh", ".meshb"), _MESHIO),
    **dict.fromkeys((".f3grid", ".mdpa", ".avs", ".ugrid", ".node", ".ele"), _MESHIO),
    **dict.fromkeys((".unv", ".cgns"), _GMSH),
}


def way_out(name: str) -> str:
    """Return advice on a file of another program, to follow a sentence; empty if unknown.

    Args:
        name: Of the file.

    >>> way_out("lever.SLDPRT")
    '; save the part as STEP (.step) in the CAD program'
    """
    stem, dot, suffix = name.rpartition(".")
    way = _WAYS.get(f"{dot}{suffix}".lower(), "")
    return (
        f"; {way.format(name=shlex.quote(name), stem=stem, mesh=shlex.quote(f'{stem}.msh'))}"
        if way
        else ""
    )
