"""Names and numbers as engineers and other programs write them, where a scene has others."""

from __future__ import annotations

import re
import tomllib

# By the table's class: the usual name → the key. Capitals do not matter.
_KEYS = {
    "Scene": {
        **dict.fromkeys(("dimension", "dim", "type", "analysis", "model"), "kinematics"),
        **dict.fromkeys(("bc", "bcs", "boundary", "boundary_conditions", "dirichlet"), "support"),
        **dict.fromkeys(("force", "forces", "traction", "neumann"), "load"),
        **dict.fromkeys(("interaction", "contact_pair"), "contact"),
        **dict.fromkeys(("geometry", "part"), "mesh"),
        **dict.fromkeys(("fe", "element", "elements"), "discretisation"),
        **dict.fromkeys(("discretization", "finite_element"), "discretisation"),
        **dict.fromkeys(("time", "stepping", "loadsteps", "load_steps"), "steps"),
        "name": "title",
        "t": "thickness",
        "tolerance": "accuracy",
    },
    "MeshSource": {
        **dict.fromkeys(("filename", "file_name", "path", "geometry", "mesh", "cad"), "file"),
        **dict.fromkeys(("h", "lc", "mesh_size", "element_size", "cell_size"), "size"),
        **dict.fromkeys(("element", "element_type", "cell_type"), "cell"),
        **dict.fromkeys(("constants", "variables"), "parameters"),
    },
    "Discretisation": dict.fromkeys(("order", "p", "polynomial_degree", "element"), "degree"),
    "Material": {
        **dict.fromkeys(("e", "young", "youngs", "e_modulus"), "youngs_modulus"),
        **dict.fromkeys(("elastic_modulus", "modulus", "elasticity"), "youngs_modulus"),
        **dict.fromkeys(("nu", "ν", "v", "pr", "poisson", "poisson_number"), "poissons_ratio"),
        **dict.fromkeys(("c", "d", "c_ijkl", "e_ijkl", "tensor"), "stiffness"),
        **dict.fromkeys(("group", "cells", "region", "domain", "body"), "on"),
        **dict.fromkeys(("rho", "ρ", "mass_density"), "density"),
        **dict.fromkeys(("grade", "material"), "name"),
    },
    "Support": {
        **dict.fromkeys(("group", "surface", "boundary", "where", "face", "edge"), "on"),
        **dict.fromkeys(("value", "values", "u", "fixed", "fix", "dofs"), "displacement"),
        **dict.fromkeys(("k", "spring", "springs", "spring_stiffness"), "stiffness"),
        **dict.fromkeys(("bedding", "foundation", "elastic_foundation"), "foundation_stiffness"),
        "amplitude": "path",
    },
    "Load": {
        **dict.fromkeys(("group", "surface", "boundary", "where", "face", "edge"), "on"),
        **dict.fromkeys(("t", "value", "values"), "traction"),
        **dict.fromkeys(("f", "resultant", "remote_force"), "force"),
        **dict.fromkeys(("torque", "couple"), "moment"),
        **dict.fromkeys(("point", "location", "reference_point"), "at"),
        **dict.fromkeys(("g", "gravity"), "acceleration"),
        **dict.fromkeys(("b", "density"), "body_force"),
        **dict.fromkeys(("centrifugal", "omega", "angular_velocity", "speed"), "rotation"),
        "p": "pressure",
        "amplitude": "path",
    },
    "Contact": {
        **dict.fromkeys(("mu", "μ", "µ", "friction", "cof", "fric"), "friction_coefficient"),
        **dict.fromkeys(("coefficient_of_friction", "coefficient"), "friction_coefficient"),
        **dict.fromkeys(("group", "surface", "boundary", "where", "face", "edge"), "on"),
        **dict.fromkeys(("master", "target", "with", "other", "counterpart"), "against"),
        **dict.fromkeys(("type", "kind", "condition"), "contact"),
        "friction_model": "law",
        **dict.fromkeys(("k", "stiffness", "spring", "springs", "bedding"), "foundation_stiffness"),
        **dict.fromkeys(("penalty", "eps1", "epsilon1", "ε1", "ε₁"), "penalty_parameter"),
        **dict.fromkeys(("eps", "epsilon", "ε", "regularization"), "regularisation_parameter"),
        **dict.fromkeys(("indenter", "punch", "rigid", "tool", "rigid_body"), "obstacle"),
        **dict.fromkeys(("overclosure", "press_fit", "oversize", "fit"), "interference"),
        **dict.fromkeys(("clearance", "adjust", "offset"), "interference"),
        "p": "pressure",
    },
    "Obstacle": {
        **dict.fromkeys(("r", "curvature_radius"), "radius"),
        **dict.fromkeys(("depth", "approach", "penetration"), "indentation"),
        **dict.fromkeys(("type", "kind", "geometry"), "shape"),
        **dict.fromkeys(("f", "load"), "force"),
        **dict.fromkeys(("at", "apex", "origin", "centre", "center", "point"), "position"),
        **dict.fromkeys(("n", "axis"), "normal"),
        "u": "displacement",
    },
    "HalfSpace": dict.fromkeys(("group", "groups", "surface", "boundary"), "on"),
    "Point": dict.fromkeys(("x", "position", "coordinates", "coords", "point"), "at"),
    "Line": {
        **dict.fromkeys(("start", "begin", "a"), "from"),
        **dict.fromkeys(("end", "stop", "b"), "to"),
        **dict.fromkeys(("number", "n", "num_points", "count"), "points"),
    },
    "Steps": {
        **dict.fromkeys(("n", "steps", "count", "n_steps", "num_steps"), "number"),
        **dict.fromkeys(("t_end", "total", "final", "duration"), "end"),
        **dict.fromkeys(("adaptive", "auto"), "automatic"),
        **dict.fromkeys(("dt_min", "min"), "smallest"),
        **dict.fromkeys(("dt_max", "max"), "largest"),
    },
    "SolverSettings": {
        **dict.fromkeys(("tol", "rtol", "atol"), "tolerance"),
        **dict.fromkeys(("max_iter", "maxiter", "max_it", "iterations"), "max_iterations"),
        **dict.fromkeys(("method", "algorithm"), "strategy"),
        **dict.fromkeys(("linear_solver", "type"), "solver"),
        **dict.fromkeys(("stabilization", "stabilise", "stabilize"), "stabilisation"),
    },
    "Path": {
        **dict.fromkeys(("t", "times"), "time"),
        **dict.fromkeys(("factors", "value", "values", "amplitude"), "factor"),
    },
    "Profile": {
        **dict.fromkeys(("axis", "direction"), "along"),
        **dict.fromkeys(("x", "coordinates", "points"), "at"),
        "value": "values",
    },
}
# What a key means where the usual name says something else.
_REMARKS = {
    ("Load", "f", "force"): "a resultant, along the axes",
    ("Load", "gravity", "acceleration"): "along the axes; needs densities",
    ("Load", "g", "acceleration"): "along the axes; needs densities",
    ("Load", "density", "body_force"): "density times gravity, along the axes",
    ("Contact", "clearance", "interference"): "which is < 0 for a gap",
}
# Displacement components by the usual names.
_AXES = {
    name: axis
    for number, axis in enumerate("xyz", start=1)
    for name in (axis, f"u{axis}", f"u_{axis}", f"u{number}", f"d{axis}", f"disp_{axis}")
}
# Words of a text that is one of several; each counts where it is accepted.
_VALUES = {
    **_AXES,
    **dict.fromkeys(("axisymmetry", "axisym", "rotational", "2d axisymmetric"), "axisymmetric"),
    **dict.fromkeys(("solid", "three-dimensional", "spatial"), "3D"),
    **dict.fromkeys(("tied", "tie", "glued", "glue", "rough"), "bonded"),
    **dict.fromkeys(("signorini", "hard", "frictional", "frictionless"), "unilateral"),
    **dict.fromkeys(
        ("spring", "springs", "foundation", "bedding", "elastic foundation"), "winkler"
    ),
    **dict.fromkeys(("given", "pressure", "imposed"), "prescribed"),
    **dict.fromkeys(("coulomb", "evolution", "rate"), "incremental"),
    **dict.fromkeys(("frictionless", "no friction"), "none"),
    "ball": "sphere",
    **dict.fromkeys(("circle", "disc", "disk", "roller"), "cylinder"),
    **dict.fromkeys(("wall", "floor", "half-plane", "flat"), "plane"),
    **dict.fromkeys(("punch", "flat-ended punch"), "flat punch"),
    **dict.fromkeys(("ring", "annulus"), "annular punch"),
    **dict.fromkeys(("tri", "triangles", "tria"), "triangle"),
    **dict.fromkeys(("quad", "quads", "quadrangle", "rectangle"), "quadrilateral"),
    **dict.fromkeys(("multigrid", "amg", "gamg", "cg"), "iterative"),
    "newton": "monolithic",
}


def meant_key(table: str, key: str, value: object) -> str:
    """Return the key of a scene for a usual name, to follow 'did you mean'; or nothing.

    Args:
        table: Name of the table's class.
        key: As it was given.
        value: What it was given.

    >>> meant_key("Material", "E", 1000), meant_key("Support", "x", 0)
    ("'youngs_modulus'", "'displacement = { x = 0 }'")
    """
    name = key.casefold().replace("-", "_")
    if table == "Support" and name in _AXES:
        shown = value if isinstance(value, int | float) else "0"
        return f"'displacement = {{ {_AXES[name]} = {shown} }}'"
    found = _KEYS.get(table, {}).get(name, "")
    remark = _REMARKS.get((table, name, found), "")
    return f"'{found}'{f', {remark}' if remark else ''}" if found else ""


def key_of_symbol(symbol: str) -> str:
    """The key for a letter that TOML refuses in keys, such as ν; or nothing."""
    found = (keys.get(symbol.casefold()) for keys in _KEYS.values())
    return next((key for key in found if key), "")


def meant_value(text: str, accepted: list[str]) -> str:
    """Return the accepted text for a usual word; or nothing.

    Args:
        text: As it was given.
        accepted: Texts.

    >>> meant_value("ball", ["plane", "sphere"])
    'sphere'
    """
    found = _VALUES.get(text.casefold(), "")
    return found if found in accepted else ""


# What is no part of a longer number or word.
_ALONE = r"(?<![\w.])"
# What is wrong, how it is found, and what stands in its place. Order matters: signs first.
NUMBER_SLIPS = (
    ("a minus sign is -", re.compile("[−–](?=[.\\d])"), "-"),
    (
        "an exponent is written with e",
        re.compile(_ALONE + r"([+-]?[\d.]+)[dD]([+-]?\d+)\b"),
        r"\1e\2",
    ),
    ("a number begins with a digit", re.compile(r"(?<![\w.)\]\"'])([+-]?)\.(?=\d)"), r"\g<1>0."),
    (
        "a digit follows the point of a number",
        re.compile(_ALONE + r"([+-]?\d+)\.(?![\d\w])|" + _ALONE + r"([+-]?\d+)\.(?=[eE][+-]?\d)"),
        r"\1\2.0",
    ),
    ("a number has no zeros in front", re.compile(_ALONE + r"([+-]?)0+(?=\d)"), r"\1"),
)
# A decimal comma is one only where no list can be meant.
COMMA = re.compile(r"^(\s*[+-]?\d+),(\d+(?:[eE][+-]?\d+)?\s*)$")


def meant_number(text: str) -> str:
    """The number that a text was meant to be, as TOML writes it; or nothing.

    >>> meant_number(".3"), meant_number("0,3"), meant_number("2.1D5"), meant_number("top")
    ('0.3', '0.3', '2.1e5', '')
    """
    text = COMMA.sub(r"\1.\2", text.strip())
    for _, pattern, into in NUMBER_SLIPS:
        text = pattern.sub(into, text)
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except (ValueError, RecursionError):
        return ""
    return text if isinstance(value, int | float) and not isinstance(value, bool) else ""
