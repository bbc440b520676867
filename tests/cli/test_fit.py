"""``fenics-contact fit`` writes what it found, and refuses in a sentence what it cannot use."""

import json

import pytest
from mpi4py import MPI

from fenics_contact import load_scene, main, run
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
        ([], "fit: --parameters KEY[=LOW:HIGH],… is missing"),
        (["--parameters", "contact.0.friction"], "the scene has no such key"),
        (["--parameters", f"{FRICTION}=.4:1"], "the search begins at the scene's 0.3"),
        (["--parameters", FRICTION, "--of", "normal_force"], "there is no column 'normal_force'"),
        (["--parameters", PUSH], "has a column of it, so that it is known"),
        (["--parameters", FRICTION, "--set", "accuracy=1e-2"], "accuracy: a study keeps one mesh"),
    ],
)
def test_what_cannot_be_used_is_refused(tmp_path, capsys, words, said):
    data = written(tmp_path, [(-900, 180)])
    assert main(["fit", SLAB, data, *words, "--out", str(tmp_path / "out")]) == 2
    err = capsys.readouterr().err
    assert said in err and len(err.strip().splitlines()) == 1
    assert not (tmp_path / "out").exists()


@alone
def test_a_file_that_is_not_there_is_refused(tmp_path, capsys):
    words = ["--parameters", FRICTION, "--out", str(tmp_path / "out")]
    assert main(["fit", SLAB, str(tmp_path / "none.csv"), *words]) == 2
    assert "none.csv: cannot be read: No such file or directory" in capsys.readouterr().err


@pytest.mark.skipif(MPI.COMM_WORLD.size == 1, reason="of several ranks")
def test_several_ranks_are_refused(capsys):
    assert main(["fit", SLAB, "data.csv", "--parameters", FRICTION]) == 2
    if MPI.COMM_WORLD.rank == 0:
        assert "fit: it runs on one rank; start it without mpirun" in capsys.readouterr().err
