"""Results with units: what people read bears them, files have numbers as without."""

import json
import re

import numpy as np
from mpi4py import MPI

from fenics_contact import Contact, Load, Material, Obstacle, Run, Scene, Support, Units
from fenics_contact.common.parallel import on_root
from fenics_contact.report.page.tables import (
    contact_table,
    errors_table,
    preloads_table,
    quantities_table,
    reactions_table,
)
from fenics_contact.results.quantities import headlines, measured_by_parameter
from fenics_contact.results.result import read_result
from fenics_contact.results.tables import branch_rows
from fenics_contact.simulation.output import run_folder as files
from tests.records import made_result, made_run
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
UNITS = {"length": "mm", "force": "N", "stress": "MPa", "energy": "mJ"}


def row(total):
    return {"mesh": total, "total": total}


def content(**changes):
    quantities = {"normal_force": 200.0, "max_contact_pressure": 12.0, "friction_work": 2.0}
    contact = {
        "name": "lug",
        "law": "static",
        "parameters": {"penalty_parameter": 1e-5, "friction_coefficient": 0.5},
        "quantities": quantities,
        "errors": {"normal_force": row(4.7)},
    }
    preload = {"on": "shank", "force": 2e4, "elongation": 0.05, "initial_strain": -1e-3}
    return {
        "converged": True,
        "contacts": [contact],
        "quantities": quantities | {"reaction": [0.0, -200.0]},
        "errors": {"normal_force": row(4.7), "reaction": row(3.7e-15)},
        "supports": [{"name": "wall", "on": "left", "reaction": [0.0, -200.0]}],
        "reactions": {"wall": {"reaction": [0.0, -200.0]}},
        "preloads": {"bolt": preload | {"locked": False, "errors": {"force": row(50.0)}}},
        "model": {"kinematics": "3D"},
        "units": UNITS,
    } | changes


def test_lines_that_matter_have_units():
    assert headlines(made_result(**content())) == [
        "Preload 'bolt': force 20000 ± 50 N.",
        "Contact 'lug': presses with 200 ± 5 N, peak pressure 12 ± ? MPa.",
        "Friction dissipated 2 ± ? mJ.",
    ]
    per_length = UNITS | {"per_unit_thickness": True}
    said = headlines(made_result(**content(units=per_length)))
    assert said[1] == "Contact 'lug': presses with 200 ± 5 N/mm, peak pressure 12 ± ? MPa."
    assert said[2] == "Friction dissipated 2 ± ? mJ/mm."


def test_notebooks_show_units():
    result = made_result(**content())
    assert "normal force: 200 ± 5 N" in repr(result)
    assert "elongation of bolt: 0.05 ± ? mm" in repr(result)
    page = result._repr_html_()
    assert '<th scope="col">unit</th>' in page and "<td>200</td><td>5</td><td>N</td>" in page
    without = made_result(**content(units=None))
    assert "normal force: 200 ± 5\n" in repr(without) and "unit" not in without._repr_html_()


def test_tables_of_the_report_have_units():
    run = made_run(content())
    (contact,) = run.contacts
    every = quantities_table(run, run.contacts, "Quantities", run)
    assert re.search(r"max contact pressure</th><td>12</td><td>MPa</td>", every)
    assert "penalty parameter (mm/MPa)" in contact_table(contact, run.units)
    assert "reaction (N)" in reactions_table(run)
    assert "force (N)" in preloads_table(run) and "elongation (mm)" in preloads_table(run)
    assert "normal force (N)" in errors_table(run)


def test_what_was_given_is_in_no_table_of_errors():
    table = errors_table(made_run(content(units=None)))
    assert "normal force" in table and "e-15" not in table and "reaction" not in table


def test_answers_from_other_starts_have_units():
    quantities = {"stick_area": 1.0, "slip_area": 2.0}
    branch = {"start": "here", "newton_iterations": 1, "passed": True, "quantities": quantities}
    branch["quantities"] |= {"normal_force": 1.0, "friction_force": [0.0, 1.0]}
    run = made_run(content(branches=[branch, branch]))
    head = branch_rows(run.branches, run.units)[0]
    assert head[1:-1] == [
        *("normal force (N)", "friction force (N)", "stick area (mm²)", "slip area (mm²)"),
    ]


def test_parameters_of_contacts_measure_what_their_keys_do():
    assert measured_by_parameter("penalty_parameter") == "length/stress"
    assert measured_by_parameter("foundation_stiffness") == "stress/length"
    assert measured_by_parameter("force") == "force"
    assert measured_by_parameter("friction_coefficient") == ""


def pressed(units):
    return Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("x0", {"x": 0}),),
        load=(Load("y1", pressure=3),),
        contact=(Contact("y0", obstacle=Obstacle(), friction_coefficient=0.2),),
        units=units,
    )


def test_units_change_no_number_of_a_run(folder):
    kept = []
    for number, units in enumerate((None, Units("mm", "kN"))):
        place = folder / str(number)
        found = files.solve_and_write(Run(pressed(units), COMM, box_body((4, 4))), place)
        assert found.converged
        kept.append(found.quantities)
        COMM.barrier()
    for name, value in kept[0].items():
        np.testing.assert_array_equal(kept[1][name], value, strict=True)
    csv = on_root(COMM, lambda: [(folder / f"{n}/contact.csv").read_bytes() for n in (0, 1)])
    assert csv[0] == csv[1] and csv[0].startswith(b"contact,x,y,z,nx,ny,nz,gap,contact_pressure,")
    written = on_root(COMM, lambda: json.loads((folder / "1/result.json").read_text()))
    expected = {"length": "mm", "force": "kN", "stress": "GPa", "energy": "J"}
    assert {name: written["units"][name] for name in expected} == expected
    assert written["units"]["per_unit_thickness"] is True
    of = written["units"]["quantities"]
    assert of["normal_force"] == "kN/mm" and of["contact_area"] == "mm"
    assert of["max_contact_pressure"] == "GPa" and of["friction_work"] == "J/mm"
    assert set(of) <= set(written["quantities"])
    assert read_result(folder / "1").units.of("force") == "kN/mm"
    assert "units" not in on_root(COMM, lambda: (folder / "0/result.json").read_text())
