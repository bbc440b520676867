"""Slips in TOML are explained in one sentence, and what is proposed is TOML."""

import re
import tomllib

import pytest
from mpi4py import MPI

from fenics_contact.scene.messages.toml_slips import what_is_wrong
from fenics_contact.scene.messages.usual_names import meant_number
from tests.messages import says

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of texts; one rank will do")

BEFORE = 'kinematics = "3D"\n[mesh]\nfile = "a.geo"\n'


def said_of(text):
    """What is said of a text that TOML refuses."""
    with pytest.raises(tomllib.TOMLDecodeError) as caught:
        tomllib.loads(text)
    found = what_is_wrong(text, caught.value)
    assert found and "\n" not in found
    return found


@pytest.mark.parametrize(
    ("slip", "meant"),
    [
        ("x = .3", "x = 0.3"),
        ("x = -.5", "x = -0.5"),
        ("x = 3.", "x = 3.0"),
        ("x = 1.e5", "x = 1.0e5"),
        ("x = 007", "x = 7"),
        ("x = 1d-3", "x = 1e-3"),
        ("x = 2.1D5", "x = 2.1e5"),
        ("x = 2,1D5", "x = 2.1e5"),
        ("x = 0,3", "x = 0.3"),
        ("x = { a = 0,3, b = .5 }", "x = { a = 0.3, b = 0.5 }"),
        ("x = −.5", "x = -0.5"),
        ("x = 210 000", "x = 210000"),
        ("x = 1000 MPa", "x = 1000"),
        ("x = True", "x = true"),
        ("x = no", "x = false"),
        ("x = plane strain", 'x = "plane strain"'),
        ("x = slab.geo # a mesh", 'x = "slab.geo" # a mesh'),
        ("x = C:\\mesh\\a.geo", "x = 'C:\\mesh\\a.geo'"),
        ('x = "C:\\mesh\\a.geo"', 'x = "C:/mesh/a.geo"'),
        ("x = [left, right]", 'x = ["left", "right"]'),
        ("x = 3D", 'x = "3D"'),
        ('x = "top', 'x = "top"'),
        ("x = 'top", "x = 'top'"),
        ("x = “top”", 'x = "top"'),
        ("x\u00a0= 3", "x = 3"),
        ("x 3", "x = 3"),
        ("x: 3", "x = 3"),
        ("x == 3", "x = 3"),
        ("x = (1, 2)", "x = [1, 2]"),
        ("x = [1 2]", "x = [1, 2]"),
        ("x = [1; 2]", "x = [1, 2]"),
        ("x = [1,, 2]", "x = [1, 2]"),
        ("x = [1, 2", "x = [1, 2]"),
        ("x = { a = 1 b = 2 }", "x = { a = 1, b = 2 }"),
        ('x = ["a" "b"]', 'x = ["a", "b"]'),
        ("x = 3;", "x = 3"),
        ("x = 3 // metres", "x = 3"),
        ("x = 3 % metres", "x = 3"),
        ("friction coefficient = 0.3", "friction_coefficient = 0.3"),
        ("ν = 0.3", "poissons_ratio = 0.3"),
        ("µ = 0.3", "friction_coefficient = 0.3"),
        ("[[contact]", "[[contact]]"),
        ("[contact]]", "[[contact]]"),
        ("[contact", "[contact]"),
    ],
)
def test_a_slip_is_named_with_its_line_and_mended(slip, meant):
    for after in ("", "\n", "\n[load]\na = 1\n"):
        found = said_of(f"{BEFORE}{slip}{after}")
        assert re.match(r"line 4: .*; write: ", found), found
        assert found.endswith(f"; write: {meant}"), found
    assert tomllib.loads(BEFORE + meant)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x =", "value_is_missing"),
        ("x = 210*1000", "toml_does_not_calculate"),
        ("x = None", "value_is_none"),
        ("x = 1,000", "number_has_a_comma"),
        ("x = { a = 1, a = 2 }", "key_given_twice"),
        ('file = "b.geo"', "key_in_two_lines"),
        ("[mesh]", "mesh_is_there_twice"),
        ("[load]\na = 1\n[[load]]\na = 1", "load_is_there_twice"),
        ("[[load]]\na = 1\n[load]\na = 1", "load_is_there_twice"),
        ("[solver]\n[solver]", "solver_is_there_twice"),
        ("x = [1,\n  2,\n  .3]", "number_begins_with_a_digit"),
        ("x = [1, 2,\n[load]\na = 1", "list_has_no_end"),
        ("x = {\n  a = 1 }", "braces_in_two_lines"),
        # what is none of these slips is said in TOML's own words, with the line
        ("x = y = 3", "toml_value_invalid"),
        ("x.y = 1\nx = 2", "toml_value_there"),
    ],
)
def test_what_cannot_be_mended_is_named(text, words):
    says(words, said_of(f"{BEFORE}{text}\n"))


def test_texts_and_comments_are_left_as_they_are():
    found = said_of(BEFORE + "x = .3 # as in [.5], 0,3 and True\n")
    assert found.endswith("write: x = 0.3 # as in [.5], 0,3 and True")
    found = said_of(BEFORE + 'x = { a = "left .5 side", b = .5 }\n')
    assert found.endswith('write: x = { a = "left .5 side", b = 0.5 }')


def test_long_lines_and_long_files_are_not_repeated():
    found = said_of(f"x = [{', '.join(['.5'] * 100)}]")
    assert found == "line 1: a number begins with a digit"
    assert said_of(" " * 50_000 + "x").endswith("(at end of document)")
    text = "# much\n" * 50_000 + "x = .3"
    assert said_of(text) == "Invalid value (at line 50001, column 5)"


@pytest.mark.parametrize(
    ("text", "number"),
    [(".3", "0.3"), ("0,3", "0.3"), (" 1D5 ", "1e5"), ("3.", "3.0"), ("7", "7"), ("−2", "-2")],
)
def test_numbers_as_other_programs_write_them(text, number):
    assert meant_number(text) == number


@pytest.mark.parametrize("text", ["top", "", "1,2,3", "true", "[1]", "1 2", "x = 3\ny = 4"])
def test_what_is_no_number_is_none(text):
    assert meant_number(text) == ""
