"""``fenics-contact fit`` writes what it found, and refuses in a sentence what it cannot use."""

import json

import pytest
from mpi4py import MPI

from fenics_contact import NotConvergedError, Study, load_scene, main, run
from tests.messages import says
from tests.scenes import ROOT

SLAB = str(ROOT / "demos" / "slab.toml")
FRICTION, PUSH = "contact.0.friction_coefficient", "load.0.traction.0"
TABLE = f"{PUSH},left.reaction_x,left.reaction_x_error\n"
alone = pytest.mark.skipif(MPI.COMM_WORLD.size > 1, reason="it runs on one rank")


def written(folder, rows):
    path = folder / "data.csv"
    path.write_text(TABLE + "".join(f"{push},{force},.01\n" for push, force in rows))
    return str(path)


@alone
def test_friction_of_the_slab_is_found_and_its_files_written(tmp_path, capsys):
    """The slab of the paper pushed so far that all of it slips, but for the node at its wall.

    That has a sixth of a cell of degree 2: friction is μ p (L − h/6), 712.5.
    """
    rubbed = 300 * (8 - 0.5 / 6)
    force = 3000 - 0.3 * rubbed
    assert run(load_scene(SLAB, [f"{PUSH}=-3000"])).supports[1].reaction[0] == pytest.approx(force)
    data, out = written(tmp_path, [(-3000, force)]), tmp_path / "found"
    start = ["--set", "contact.0.friction_coefficient=0.2", "--out", str(out)]
    key = "contact.friction_coefficient=0.1:0.37"
    assert main(["fit", SLAB, data, "--parameters", key, *start]) == 0
    said = capsys.readouterr().out
    assert f"{FRICTION} = 0.3" in said and "Wrote fit.json, fit.csv, scene.toml, fit.html" in said
    record = json.loads((out / "fit.json").read_text(encoding="utf-8"))
    found = record["parameters"][FRICTION]
    assert found["low"] < 0.3 < found["high"]
    assert found["value"] == pytest.approx(0.3, rel=1e-6)
    assert found["noise"] == pytest.approx(1.959964 * 0.01 / rubbed, rel=1e-5)
    assert record["converged"] and record["evaluations"] <= 8 and record["confidence"] == 0.95
    again = load_scene(out / "scene.toml").contact[0].friction_coefficient
    assert again == pytest.approx(0.3, abs=1e-4)
    (out / "fit.html").unlink()
    assert main(["report", str(out)]) == 0
    assert (out / "fit.html").exists()


@alone
@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "fit_without_parameters"),
        (["--parameters", "contact.0.friction"], "no_parameter_friction"),
        (["--parameters", f"{FRICTION}=.4:1"], "parameter_begins_at_the_scenes"),
        (["--parameters", FRICTION, "--of", "normal_force"], "data_without_normal_force"),
        (["--parameters", PUSH], "parameter_is_in_the_file"),
        (["--parameters", FRICTION, "--set", "accuracy=1e-2"], "study_with_accuracy"),
    ],
)
def test_what_cannot_be_used_is_refused(tmp_path, capsys, words, said):
    data = written(tmp_path, [(-900, 180)])
    assert main(["fit", SLAB, data, *words, "--out", str(tmp_path / "out")]) == 2
    err = capsys.readouterr().err
    says(said, err)
    assert len(err.strip().splitlines()) == 1
    assert not (tmp_path / "out").exists()


@alone
def test_a_file_that_is_not_there_is_refused(tmp_path, capsys):
    words = ["--parameters", FRICTION, "--out", str(tmp_path / "out")]
    assert main(["fit", SLAB, str(tmp_path / "none.csv"), *words]) == 2
    says("data_cannot_be_read", capsys.readouterr().err)


@pytest.mark.skipif(MPI.COMM_WORLD.size == 1, reason="of several ranks")
def test_several_ranks_are_refused(capsys):
    assert main(["fit", SLAB, "data.csv", "--parameters", FRICTION]) == 2
    if MPI.COMM_WORLD.rank == 0:
        says("fit_on_several_ranks", capsys.readouterr().err)


class Solves:
    """Counts curves that are solved for; in place of one of them it may raise an error."""

    def __init__(self, monkeypatch, fails_at=None, error=KeyboardInterrupt):
        self.number, tries, solve = 0, iter(range(100)), Study.history

        def counted(study, *args, **kwargs):
            if next(tries) == fails_at:
                raise error
            self.number += 1
            return solve(study, *args, **kwargs)

        monkeypatch.setattr(Study, "history", counted)


def fitted(monkeypatch, folder, *words, fails_at=None, error=KeyboardInterrupt, data=None):
    """Exit code of a fit of the slab in a folder, and how many curves were solved for."""
    data = data or written(folder.parent, [(-3000, 860.0)])
    start = ["--set", f"{FRICTION}=0.2", "--parameters", f"{FRICTION}=0.1:0.37"]
    with monkeypatch.context() as meanwhile:
        solves = Solves(meanwhile, fails_at, error)
        code = main(["fit", SLAB, data, *start, "--out", str(folder), "--quiet", *words])
    return code, solves.number


@alone
def test_an_interrupted_fit_goes_on_to_the_same_numbers(tmp_path, monkeypatch, capsys):
    """Every curve is solved for once: those of before and those of after are those of a fit."""
    whole, out = tmp_path / "whole", tmp_path / "out"
    code, every = fitted(monkeypatch, whole)
    assert code == 0 and every > 4
    assert fitted(monkeypatch, out, fails_at=2) == (130, 2)
    says("fit_is_interrupted", capsys.readouterr().err)
    assert [path.name for path in out.iterdir()] == ["fit.journal"]
    assert fitted(monkeypatch, out, "--resume", fails_at=every - 3) == (130, every - 3)
    assert not (out / "fit.json").exists()
    assert fitted(monkeypatch, out, "--resume") == (0, 1)
    records = [json.loads((folder / "fit.json").read_text()) for folder in (whole, out)]
    for record in records:
        for key in ("value", "low", "high", "noise", "discretisation"):
            given, found = (one["parameters"][FRICTION][key] for one in (records[0], record))
            assert found == pytest.approx(given, rel=1e-9)
        assert record["evaluations"] == records[0]["evaluations"] == every
        assert (record["verdict"], record["checks"]) == (records[0]["verdict"], [])
    assert fitted(monkeypatch, out, "--resume") == (0, 0)  # all of it is known
    assert fitted(monkeypatch, out) == (0, every)


@alone
def test_what_has_no_answer_is_not_tried_again(tmp_path, monkeypatch):
    """A step that ends without one is part of the search, and of its journal."""
    out = tmp_path / "out"
    error = NotConvergedError("no answer")
    code, solved = fitted(monkeypatch, out, fails_at=1, error=error)
    record = json.loads((out / "fit.json").read_text(encoding="utf-8"))
    assert code == 0 and record["evaluations"] == solved + 1
    assert fitted(monkeypatch, out, "--resume") == (0, 0)
    assert json.loads((out / "fit.json").read_text(encoding="utf-8")) == record


@alone
@pytest.mark.parametrize(
    ("words", "rows", "differs"),
    [
        (["--set", "material.0.youngs_modulus=2e5"], None, "material of the scene"),
        (["--parameters", "load.0.traction.1"], None, "the parameters"),
        ([], [(-3000, 870.0)], "the measured curve"),
        (
            ["--set", f"{FRICTION}=0.3"],
            [(-3000, 1.0)],
            "contact of the scene, the measured curve",
        ),
    ],
)
def test_the_journal_of_another_fit_is_refused(words, rows, differs, tmp_path, monkeypatch, capsys):
    out = tmp_path / "out"
    fitted(monkeypatch, out, fails_at=1)
    before = (out / "fit.journal").read_bytes()
    capsys.readouterr()
    data = rows and written(tmp_path, rows)
    assert fitted(monkeypatch, out, *words, "--resume", data=data) == (2, 0)
    err = capsys.readouterr().err
    assert len(err.strip().splitlines()) == 1
    says("resume_of_another_fit", err, differs=differs)
    assert (out / "fit.journal").read_bytes() == before
    (out / "fit.journal").write_bytes(b"nothing of the kind, but some bytes")
    assert fitted(monkeypatch, out, "--resume") == (2, 0)
    says("resume_of_a_damaged_fit", capsys.readouterr().err)
