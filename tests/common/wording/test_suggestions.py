import pytest
from mpi4py import MPI

from fenics_contact.common.wording import (
    did_you_mean,
    nearest,
    nearest_file,
    question,
)

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of texts; one rank will do")


@pytest.mark.parametrize(
    ("word", "known", "found"),
    [
        ("topp", ["top", "bottom"], ["top"]),
        ("TOP", ["top", "bottom"], ["top"]),
        ("half-space", ["half_space", "space"], ["half_space"]),
        ("zzz", ["top", "bottom"], []),
        ("", ["top"], []),
    ],
)
def test_the_nearest_name(word, known, found):
    assert nearest(word, known) == found


def test_sentences_end_with_a_question_or_not_at_all():
    assert did_you_mean("rnu", ["run", "new"]) == "; did you mean run?"
    assert did_you_mean("zzz", ["run", "new"]) == question("zzz", ["run"]) == ""
    assert question("rnu", ["run", "new"]) == " (did you mean 'run'?)"


def test_files_are_sought_among_those_of_their_kind(tmp_path):
    for name in ("slab.toml", "slab.geo"):
        (tmp_path / name).touch()
    assert nearest_file(tmp_path / "slap.geo") == " (did you mean 'slab.geo'?)"
    assert nearest_file(tmp_path / "bar.geo") == ""  # but for its ending, it is no word like slab
    assert nearest_file(tmp_path / "none" / "slab.geo") == ""
