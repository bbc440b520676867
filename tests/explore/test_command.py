"""``fenics-contact explore``: its errors are one sentence, and Ctrl-C is its ordinary end."""

import re
import signal
import socket
import subprocess
import sys
import urllib.request

import pytest
from mpi4py import MPI

from fenics_contact import Study, main
from fenics_contact.explore.messages import Exchange
from tests.messages import refused, says
from tests.scenes import ROOT, slab

SLAB = str(ROOT / "demos" / "slab.toml")


def refusal(capsys, *options, scene=SLAB):
    """What is said of options that are refused, on rank 0."""
    assert main(["explore", str(scene), "--no-browser", *options]) == 2
    said = capsys.readouterr().err
    assert len(said.strip().splitlines()) == (MPI.COMM_WORLD.rank == 0)
    return said


@pytest.mark.skipif(MPI.COMM_WORLD.size == 1, reason="of several ranks")
def test_several_ranks_are_told_to_start_it_alone(capsys):
    said = refusal(capsys)
    if MPI.COMM_WORLD.rank == 0:
        says("explore_on_several_ranks", said)
    with refused("explore_on_several_ranks"):
        Study(slab()).explore()


@pytest.mark.serial
def test_what_cannot_be_explored_is_said(capsys, tmp_path):
    for options, said in (
        (["--vary", "load.0.tractoin.0=1:2"], "vary_tractoin"),
        (["--vary", "load.0.traction.0=2:1"], "vary_from_2_to_1"),
        (["--vary", "load.0.on=1:2"], "vary_group_right"),
        (["--set", "accuracy=1e-2"], "study_with_accuracy"),
    ):
        says(said, refusal(capsys, *options))
    says("scene_none_cannot_be_read", refusal(capsys, scene=tmp_path / "none.toml"))
    says("host_of_others", refusal(capsys, "--host", "192.0.2.1"), host="192.0.2.1")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        says("port_in_use", refusal(capsys, "--port", port), port=port)


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
        ("contact.0.friction_coefficient=1e-3", 2, "loads_exceed_friction_at_time_1_5"),
        ("solver.max_iterations=1", 3, "newton_steps_used_up"),
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
    says(words, said)
    assert len(said.splitlines()) == 1
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
