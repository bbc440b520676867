"""``fenics-contact explore``: its errors are one sentence, and Ctrl-C is its ordinary end."""

import re
import signal
import socket
import subprocess
import sys
import urllib.request

import pytest
from mpi4py import MPI

from fenics_contact import InputError, Study, main
from fenics_contact.explore.requests import Exchange
from tests.scenes import ROOT, slab

SLAB = str(ROOT / "demos" / "slab.toml")


def refused(capsys, *options, scene=SLAB):
    """What is said of options that are refused, on rank 0."""
    assert main(["explore", str(scene), "--no-browser", *options]) == 2
    said = capsys.readouterr().err
    assert len(said.strip().splitlines()) == (MPI.COMM_WORLD.rank == 0)
    return said


@pytest.mark.skipif(MPI.COMM_WORLD.size == 1, reason="of several ranks")
def test_several_ranks_are_told_to_start_it_alone(capsys):
    said = refused(capsys)
    assert (
        MPI.COMM_WORLD.rank > 0 or "on one rank, and there are 2: start it without mpirun" in said
    )
    with pytest.raises(InputError, match="start it without mpirun"):
        Study(slab()).explore()


@pytest.mark.serial
def test_what_cannot_be_explored_is_said(capsys, tmp_path):
    assert "no such key" in refused(capsys, "--vary", "load.0.tractoin.0=1:2")
    assert "must be less than" in refused(capsys, "--vary", "load.0.traction.0=2:1")
    assert "is not a number in the scene, but 'right'" in refused(capsys, "--vary", "load.0.on=1:2")
    assert "leave accuracy out" in refused(capsys, "--set", "accuracy=1e-2")
    assert "cannot be read" in refused(capsys, scene=tmp_path / "none.toml")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        assert f"--port {port}: another program listens there" in refused(capsys, "--port", port)
    assert "not an address of this machine" in refused(capsys, "--host", "192.0.2.1")


@pytest.fixture
def own_scene(tmp_path, monkeypatch):
    """A block that is pressed on a rough floor, and pulled along it."""
    monkeypatch.chdir(tmp_path)
    main(["new", "own", "--quiet"])
    return "own.toml"


@pytest.mark.serial
@pytest.mark.parametrize(
    ("setting", "code", "words"),
    [
        ("contact.0.friction_coefficient=1e-3", 2, "no equilibrium at time 1.5: the supports"),
        ("solver.max_iterations=1", 3, "the Newton steps allowed were used up"),
    ],
)
def test_a_scene_without_an_answer_ends_it_as_a_run(
    setting, code, words, own_scene, monkeypatch, capsys
):
    def ended(*_):
        raise KeyboardInterrupt  # were it to serve, it would end with 0

    monkeypatch.setattr(Exchange, "take", ended)
    before = signal.getsignal(signal.SIGTERM)
    try:
        assert main(["explore", own_scene, "--no-browser", "--quiet", "--set", setting]) == code
    finally:
        signal.signal(signal.SIGTERM, before)
    said = capsys.readouterr().err.strip()
    assert words in said and len(said.splitlines()) == 1
    assert main(["explore", own_scene, "--no-browser", "--quiet"]) == 0
    signal.signal(signal.SIGTERM, before)


@pytest.mark.serial
@pytest.mark.parametrize("option", [["--port", "0"], ["--port", "70000"], ["--port", "x"]])
def test_a_port_that_is_none_is_refused(option, capsys):
    with pytest.raises(SystemExit) as end:
        main(["explore", SLAB, *option])
    assert end.value.code == 2
    assert "--port" in capsys.readouterr().err


@pytest.mark.serial
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_it_serves_its_page_at_once_and_ends_with_0(number):
    """Whatever it is doing: here it condenses the body."""
    command = [sys.executable, "-m", "fenics_contact", "explore", SLAB, "--no-browser"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    ) as process:  # fmt: skip
        address = process.stdout.readline().strip()
        assert re.fullmatch(r"http://127\.0\.0\.1:\d+/[\w-]{32}/", address)
        page = urllib.request.urlopen(address, timeout=60).read().decode()
        process.send_signal(number)
        _, err = process.communicate(timeout=60)
    assert "friction coefficient" in page
    assert (process.returncode, err) == (0, "")
