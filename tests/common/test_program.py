"""What the program says of how to cite it is what CITATION.cff says."""

import re
import tomllib

import fenics_contact
from fenics_contact.common import program
from tests.scenes import ROOT

CFF = (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def of(key, text=CFF):
    """The first value of a key."""
    return re.search(rf"^[ -]*{key}: (.*)$", text, re.MULTILINE).group(1)


def test_it_is_that_of_the_file():
    ours, paper = CFF.split("references:")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert program.VERSION == of("version", ours) == project["version"]
    assert fenics_contact.__version__ == program.VERSION
    for text in (program.PROGRAM, program.PROGRAM_BIBTEX):
        assert of("license", ours) in text
        assert of("name", ours) in text.replace("\\_", "_")
        assert of("title", ours) in text.replace("\\_", "_")
    names = re.findall(r"family-names: (.*)\n *given-names: (.*)", paper)
    assert len(names) == 3
    for family, given in names:
        assert f"{given} {family}" in program.PAPER
    authors = " and ".join(f"{family}, {given}" for family, given in names)
    assert f"author  = {{{authors}}}" in program.PAPER_BIBTEX
    entries = re.sub(" +", " ", program.PAPER_BIBTEX)
    for key in ("title", "journal", "volume", "year"):
        assert of(key, paper) in program.PAPER
        assert f"\n {key} = {{{of(key, paper)}}}" in entries
    first, last = of("start", paper), of("end", paper)
    assert f"{first}-{last}" in program.PAPER
    assert f"{{{first}--{last}}}" in program.PAPER_BIBTEX


def test_bibtex_is_balanced():
    text = program.bibtex()
    assert text.count("{") == text.count("}")
    assert re.findall(r"^@(\w+)", text, re.MULTILINE) == ["article", "misc"]
    assert program.how_to_cite() == f"{program.PAPER} {program.PROGRAM}"
