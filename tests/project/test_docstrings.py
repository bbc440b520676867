"""Docstrings: examples in them are run, and those of the public names are complete."""

import dataclasses
import doctest
import importlib
import inspect
import os
import re

import pytest
from mpi4py import MPI

import fenics_contact
from tests.scenes import ROOT

COMM = MPI.COMM_WORLD
PACKAGE = ROOT / "fenics_contact"
MODULES = sorted(
    ".".join(path.relative_to(ROOT).with_suffix("").parts)
    for path in PACKAGE.rglob("*.py")
    if re.search(r"^ *>>> ", path.read_text(encoding="utf-8"), re.MULTILINE)
)
PUBLIC = fenics_contact.__all__


@pytest.mark.parametrize("name", MODULES)
def test_examples_are_right(name, folder, monkeypatch):
    """In an empty folder, as they write files; on any number of ranks."""
    monkeypatch.chdir(folder)
    module = importlib.import_module(name)
    found = doctest.testmod(module, optionflags=doctest.ELLIPSIS)
    assert found.attempted > 0 and found.failed == 0


def test_a_wrong_example_fails():
    """The runner is able to fail, and sees classes that ``scene_class`` makes."""
    finder, failed = doctest.DocTestFinder(), doctest.DocTestRunner(verbose=False)
    names = {test.name: test for test in finder.find(fenics_contact.scene.values)}
    assert names["fenics_contact.scene.values.Profile"].examples
    wrong = doctest.DocTestParser().get_doctest(">>> 1 + 1\n3\n", {}, "wrong", None, 0)
    with open(os.devnull, "w") as nowhere:
        assert failed.run(wrong, out=nowhere.write).failed == 1


def sections(text):
    return re.findall(r"^([A-Z]\w+):$", text, re.MULTILINE)


def entries(text):
    """What its sections say something of."""
    return set(re.findall(r"^    (\w+):", text, re.MULTILINE))


def parameters(thing):
    if inspect.isclass(thing):
        if dataclasses.is_dataclass(thing):
            return [field.name for field in dataclasses.fields(thing)]
        thing = thing.__init__
        if not inspect.isfunction(thing):
            return []
    names = [name for name in inspect.signature(thing).parameters if name != "self"]
    return names


@pytest.mark.parametrize("name", PUBLIC)
def test_public_names_say_what_their_parameters_are(name):
    thing = getattr(fenics_contact, name)
    text = inspect.getdoc(thing)
    assert not [one for one in parameters(thing) if one not in entries(text)]
    if inspect.isfunction(thing):
        assert {"Args", "Returns", "Raises"} <= set(sections(text))
    elif not issubclass(thing, Exception):
        assert "Attributes" in sections(text)


@pytest.mark.parametrize(
    "name", [name for name in PUBLIC if inspect.isclass(getattr(fenics_contact, name))]
)
def test_public_methods_say_what_their_parameters_are(name):
    for method, thing in vars(getattr(fenics_contact, name)).items():
        function = thing.fget if isinstance(thing, property) else getattr(thing, "func", thing)
        if (method.startswith("_") and method != "__call__") or not inspect.isfunction(function):
            continue
        text = inspect.getdoc(function)
        assert text, method
        missing = [one for one in parameters(function) if one not in entries(text)]
        assert not missing, f"{method}: {missing}"


def test_the_public_names_are_where_they_are_said_to_be():
    """``_MODULES`` of the package, ``__all__``, and what type checkers see."""
    said = [name for names in fenics_contact._MODULES.values() for name in names]
    assert sorted(said) == sorted(PUBLIC)
    source = (PACKAGE / "__init__.py").read_text(encoding="utf-8")
    checked = {
        name.strip()
        for names in re.findall(r"^    from fenics_contact\.[\w.]+ import ([^()]*?)$", source, re.M)
        for name in names.split(",")
    }
    for names in re.findall(r"^    from fenics_contact\.[\w.]+ import \(([^)]*)\)", source, re.M):
        checked |= {name.strip() for name in names.split(",") if name.strip()}
    assert checked == set(PUBLIC)
    assert sorted(PUBLIC) == dir(fenics_contact)
    with pytest.raises(AttributeError, match="has no attribute 'Scenes'"):
        fenics_contact.Scenes  # noqa: B018


def test_docstrings_of_properties_are_no_types():
    """Sphinx takes what stands before a colon in the first line of a property for its type."""
    properties = [
        (f"{name}.{key}", found)
        for name in PUBLIC
        if inspect.isclass(thing := getattr(fenics_contact, name))
        for key, found in inspect.getmembers(thing, lambda part: isinstance(part, property))
    ]
    first = {name: (inspect.getdoc(found) or "").split("\n")[0] for name, found in properties}
    assert properties and [name for name, line in first.items() if ": " in line] == []
