"""Temperatures in results, from files, in units, and on bodies that are kept."""

from dataclasses import replace
from pathlib import Path as FilePath

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Line, Material, Point, Profile, Study, Support, Temperature, run
from fenics_contact.scene.reading import scene_of_text
from fenics_contact.scene.units.table import Units
from tests.body.thermal.test_temperatures import ALPHA, CELLS, E, block, held_as_needed, scene
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
RISING = Profile(along="x", at=(0, 3), values=(20, 80))


def _bar(temperature, **more):
    """A block between two walls, hot at its right end."""
    held = (Support("x0", {"x": 0.0}), Support("x1", {"x": 0.0}), Support("y0", {"y": 0.0}))
    return scene("plane stress", temperature, support=held, **more)


def _body():
    return block("plane stress", CELLS["plane stress"][0])


def test_temperatures_are_quantities():
    made = _bar(
        Temperature(value=RISING, path=lambda time: 0.5),
        point=(Point("middle", (1.5, 1.0)), Point("end", (3.0, 0.3))),
        line=(Line("along", (0.0, 0.7), (4.0, 0.7), points=5),),
    )
    found = run(made, COMM, _body())
    assert found.quantities["max_temperature"] == pytest.approx(50)
    assert found.quantities["temperature_middle"] == pytest.approx(35)
    assert found.quantities["temperature_end"] == pytest.approx(50)
    (line,) = found.lines
    assert line.temperature[:4] == pytest.approx([20, 30, 40, 50])
    assert line.temperature[4] is None
    assert "max_temperature" not in found.errors


def _written(folder, name, temperature):
    """A file of places around the body, in one of all formats, with a temperature at each."""
    import meshio

    grid = np.stack(np.meshgrid(np.linspace(-1, 4, 6), np.linspace(-1, 3, 5)), axis=-1)
    places = np.zeros((30, 3))
    places[:, :2] = grid.reshape(-1, 2)
    values = temperature(places.T)
    file = folder / name
    if COMM.rank == 0:
        if name.endswith(".csv"):
            rows = np.column_stack([places, values])
            np.savetxt(file, rows, delimiter=",", header="x,y,z,T", comments="")
        else:
            firsts = [6 * j + i for j in range(4) for i in range(5)]
            quads = np.array(firsts)[:, None] + [0, 1, 7, 6]
            data = {"T": values, "other": 2 * values}
            meshio.Mesh(places, [("quad", quads)], point_data=data).write(file)
    COMM.barrier()
    return str(file)


@pytest.mark.parametrize("name", ["field.csv", "field.vtu", "field.xdmf", "field.med"])
def test_a_field_of_a_file(folder, name):
    """Linear in the plane: the same as the function, wherever its places are."""

    def temperature(x):
        return 20 + 30 * x[0] - 14 * x[1]

    file = _written(folder, name, temperature)
    field = None if name.endswith(".csv") else "T"
    point = (Point("inside", (1.7, 0.6)),)
    given, read = (
        run(_bar(one, point=point), COMM, _body()).quantities
        for one in (Temperature(value=temperature), Temperature(file=file, field=field))
    )
    for name_of in ("stress_inside_xx", "strain_energy", "max_temperature"):
        assert read[name_of] == pytest.approx(given[name_of], rel=1e-10)


def test_files_that_are_refused(folder):
    file = _written(folder, "field.vtu", lambda x: x[0])
    with refused("which_field_of_a_temperature"):
        run(_bar(Temperature(file=file)), COMM, _body())
    with refused("no_such_field_of_a_temperature"):
        run(_bar(Temperature(file=file, field="heat")), COMM, _body())
    far = box_body((3, 2), (30, 2), CELLS["plane stress"][0])
    with refused("temperatures_beyond_their_places"):
        run(_bar(Temperature(file=file, field="T")), COMM, far)
    if COMM.rank == 0:
        (folder / "words.csv").write_text("x,y,T\n0,0,cold\n")
    COMM.barrier()
    with refused("temperatures_that_are_no_numbers"):
        run(_bar(Temperature(file=str(folder / "words.csv"))), COMM, _body())
    with refused("no_file_of_temperatures"):
        run(_bar(Temperature(file=str(folder / "none.csv"))), COMM, _body())
    with refused("no_format_of_temperatures"):
        run(_bar(Temperature(file=str(folder / "field.stl"))), COMM, _body())


def test_a_further_temperature_needs_no_new_body():
    made = _bar(Temperature(value=120), point=(Point("inside", (1.7, 0.6)),))
    study = Study(made, COMM, _body())
    for value, alpha in ((120, ALPHA), (70, ALPHA), (70, 2 * ALPHA)):
        found = study.solve({"temperature.0.value": value, "material.0.thermal_expansion": alpha})
        pressed = -E * alpha * (value - 20)
        assert found.quantities["stress_inside_xx"] == pytest.approx(pressed, rel=1e-10)
    assert study.factorisations == 1


UNITS = """
kinematics = "plane stress"
units = {{ length = "mm", force = "N", temperature = "{scale}" }}
mesh = {{ file = "none.msh" }}
material = {{ youngs_modulus = "210 GPa", poissons_ratio = 0.3, thermal_expansion = "12e-6 1/K", \
reference_temperature = "{cold}" }}
[[temperature]]
value = "{hot}"
"""


def test_temperatures_with_units():
    text = UNITS.format(scale="°C", cold="20 °C", hot="120 °C")
    made = scene_of_text(text, FilePath("scene.toml"))
    assert made.temperature[0].value == 120
    assert made.material[0].thermal_expansion == pytest.approx(ALPHA)
    assert made.unit_names.of("1/temperature") == "1/°C"
    with refused("temperature_on_the_other_scale"):
        scene_of_text(UNITS.format(scale="K", cold="293 K", hot="120 °C"), FilePath("scene.toml"))
    named = text.replace("youngs_modulus", 'name = "steel S355", youngs_modulus')
    assert scene_of_text(named, FilePath("scene.toml")).material[0].density == pytest.approx(
        7.85e-9
    )


def test_units_of_temperatures_are_those_of_the_scene():
    made = _bar(Temperature(value=120), units=Units("mm", "N", "°C"))
    units = run(made, COMM, _body()).units
    assert units.of("temperature") == "°C"
    assert units.quantities["max_temperature"] == "°C"


def test_a_temperature_is_no_unknown_of_users():
    found = run(_bar(Temperature(value=120)), COMM, _body())
    assert found.model.scalar_unknowns == []
    assert "temperature" in found.model.terms


def test_a_material_by_name_expands():
    made = Material(name="steel S355")
    assert made.by_name["thermal_expansion"] == "12e-6 1/K"
    assert "thermal_expansion" not in replace(made, thermal_expansion=1e-6).by_name


def test_a_field_without_a_z_does_not_change_along_it(folder):
    """Of what expands along x alone the end moves by ∫ α ΔT dx, without stress."""
    file = _written(folder, "field.csv", lambda x: 20 + 10 * x[0])
    made = scene(
        "3D",
        Temperature("body", file=file),
        material=Material(E, 0.3, thermal_expansion=(ALPHA, 0, 0), reference_temperature=20),
        support=held_as_needed("3D"),
        point=(Point("end", (3.0, 2.0, 1.0)),),
    )
    found = run(made, COMM, block("3D", CELLS["3D"][0]))
    moved = [ALPHA * 10 * 3.0**2 / 2, 0, 0]
    assert found.quantities["displacement_end"] == pytest.approx(moved, rel=1e-9, abs=1e-12)
