"""Sentences of messages stand once, in tests/messages.toml, and tests name them."""

import re

import pytest
from mpi4py import MPI

from fenics_contact import InputError
from fenics_contact.common.errors import MachineError, SceneError
from tests import messages
from tests.messages import FILE, SENTENCES, ends_with, is_said, refused, says
from tests.scenes import ROOT

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of texts; one rank will do")

SOURCES = {
    path: path.read_text(encoding="utf-8")
    for path in sorted((ROOT / "tests").rglob("*.py"))
    if path.name != "test_messages.py"
}


def unnamed(names, sources):
    """Those of names that no source has in quotes."""
    quoted = set(re.findall(r'"(\w+)"', "\n".join(sources)))
    return set(names) - quoted


def unwritten(names, sources):
    """What sources give as a message's name, but for those that have a sentence."""
    return set(re.findall(r'\b(?:refused|says)\(\s*"(\w+)"', "\n".join(sources))) - set(names)


def alike(sentences):
    """Pairs of names of which one's sentence says what the other's does."""
    return {
        (name, other)
        for name, sentence in sentences.items()
        for other, text in sentences.items()
        if name != other and (sentence == text or ("…" in sentence and is_said(sentence, text, {})))
    }


def test_each_sentence_has_a_test_and_each_name_a_sentence():
    assert not unnamed(SENTENCES, SOURCES.values())
    assert not unwritten(SENTENCES, SOURCES.values())
    assert unnamed(["a_b", "c"], ['refused("a_b")', "c"]) == {"c"}
    assert unwritten(["a"], ['refused("a"), says("b", text)']) == {"b"}


def test_one_message_has_one_name():
    assert not alike(SENTENCES)
    assert alike({"a": "x = 1", "b": "x = …", "c": "x = 1; y"}) == {("b", "a")}


def test_the_file_is_sorted():
    names = re.findall(r"^(\w+) = ", FILE.read_text(encoding="utf-8"), re.MULTILINE)
    assert names == sorted(SENTENCES)


@pytest.fixture
def known(monkeypatch):
    """Sentences of these tests alone."""
    sentences = {"too_soft": "'…/a.toml': {key} = -1 must be > 0; stiffen it"}
    monkeypatch.setattr(messages, "SENTENCES", sentences)
    monkeypatch.setattr(messages, "WRITTEN", None)
    return sentences


SAID = "'/tmp/x/a.toml': k = -1 must be > 0; stiffen it"


@pytest.mark.parametrize(
    ("error", "name", "key"),
    [
        (InputError(SAID.replace("stiffen", "soften")), "too_soft", "k"),  # said otherwise
        (InputError(SAID + "!"), "too_soft", "k"),
        (InputError("'b'; c" + SAID[1:]), "too_soft", "k"),  # … is no other sentence
        (InputError(SAID), "too_soft", "m"),  # of another key
        (InputError(SAID), "too_hard", "k"),
        (None, "too_soft", "k"),
    ],
)
def test_what_is_said_otherwise_fails(error, name, key, known):
    def refuse():
        if error is not None:
            raise error

    with pytest.raises(pytest.fail.Exception, match=name), refused(name, key=key):
        refuse()


def test_what_is_said_passes_by_an_error_of_its_kind(known):
    for kind in (InputError, SceneError):
        with refused("too_soft", key="k") as caught:
            raise kind(SAID)
        assert type(caught.value) is kind
    with pytest.raises(MachineError), refused("too_soft", key="k"):
        raise MachineError(SAID)
    with pytest.raises(InputError), refused("too_soft", SceneError, key="k"):
        raise InputError(SAID)


def test_a_command_says_it_on_a_line(known):
    says("too_soft", f"warning\nfenics-contact: {SAID}\n", key="k")
    with pytest.raises(pytest.fail.Exception, match="too_soft"):
        says("too_soft", SAID.replace("; ", ";\n"), key="k")
    assert ends_with("a … c", "- a b c", {}) and not is_said("a … c", "- a b c", {})
    assert not ends_with("a … c", "a b c -", {})


def test_sentences_are_written_once(known, monkeypatch, tmp_path):
    monkeypatch.setattr(messages, "WRITTEN", {})
    monkeypatch.setattr(messages, "FILE", tmp_path / "messages.toml")
    with refused("not_there"):
        raise InputError(f'{tmp_path}/b.toml: no "b"')
    says("too_soft", "first\n'/tmp/c.toml': k = -1 must be > 0; harden it", key="k")
    with pytest.raises(pytest.fail.Exception, match="not_there"):  # two messages of one name
        says("not_there", "another")
    messages.write()
    assert (tmp_path / "messages.toml").read_text(encoding="utf-8") == (
        'not_there = "…/b.toml: no \\"b\\""\n'
        "too_soft = \"'/tmp/c.toml': {key} = -1 must be > 0; harden it\"\n"
    )
