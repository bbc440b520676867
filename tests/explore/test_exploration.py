"""From a request to an answer: what the page is told is what the study finds."""

import asyncio
import dataclasses
import tomllib

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    Obstacle,
    Scene,
    Steps,
    Study,
    Support,
    load_scene,
    main,
)
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.explore.exploration import Exploration
from fenics_contact.explore.explorer import Explorer
from tests.explore.talking import row, talk
from tests.messages import refused, says
from tests.scenes import ROOT, box_body
from tests.simulation.studies.cases import square

pytestmark = pytest.mark.serial
COEFFICIENT = "contact__0__friction_coefficient"


# A square that is held above, and pulled to a side and down onto a plane.
HUNG = Scene(
    kinematics="plane strain",
    material=Material(1000, 0.3),
    discretisation=Discretisation(1),
    support=(Support("y1", {"x": 0, "y": 0}),),
    load=(Load("x1", traction=(2, -1)),),
    contact=(Contact("y0", obstacle=Obstacle(shape="plane", position=(0, 0))),),
)


@pytest.fixture
def own(folder):
    assert main(["new", "own", "--quiet", "--out", str(folder / "own.toml")]) == 0
    return load_scene(folder / "own.toml")


@pytest.fixture
def alone():
    """Makes a study on this rank."""
    return lambda scene, body=None: Study(scene, MPI.COMM_SELF, body)


@pytest.mark.errors
def test_answers_follow_equilibrium_and_come_with_bars_when_one_lets_go(own, alone, folder):
    """A block of length 2 under a pressure, pulled by 3: the floor has to carry just these."""
    exploration = Exploration(alone(own), beside=folder)

    async def conversation(page):
        shape = await page.until("shape")
        first = await page.until("answer", 0)
        await page.ask(1, "follow", load__0__pressure=12.0, **{COEFFICIENT: 0.4})
        quick = await page.until("answer", 1)
        await page.ask(2, "solve", load__0__pressure=12.0, **{COEFFICIENT: 0.4})
        whole = await page.until("answer", 2)
        await page.ask(3, "scene", load__0__pressure=12.0, **{COEFFICIENT: 0.4})
        return shape, first, quick, whole, await page.until("scene", 3)

    shape, first, quick, whole, scene = talk(exploration, conversation)
    assert row(first, "normal force")[0] == "20"
    for answer in (quick, whole):
        assert row(answer, "normal force")[0] == "24"
        assert row(answer, "friction force")[0] == "-3, 0"
        count = shape["arrays"]["points"].size
        assert answer["arrays"]["displacement"].shape == (count,)
        x, pressure = shape["arrays"]["0.at"], answer["arrays"]["0.pressure"]
        mean = 0.5 * (pressure[1:] + pressure[:-1])
        assert mean @ np.diff(x) == pytest.approx(24, rel=0.02)
        assert set(answer["arrays"]["0.status"]) <= {0, 1, 2}
    assert not quick["whole"] and all(cells[2] == "" for cells in quick["rows"])
    assert whole["whole"] and whole["passed"] and "Converged; all" in whole["said"][0]
    assert row(whole, "strain energy")[1].startswith("± ")
    assert row(whole, "max contact pressure")[1] == "?"  # it sticks up to a right angle
    assert row(whole, "normal force")[1] == ""  # it is given
    assert np.allclose(quick["arrays"]["displacement"], whole["arrays"]["displacement"], atol=1e-6)
    (folder / "changed.toml").write_text(scene["said"][0])
    changed = load_scene(folder / "changed.toml")
    assert changed.load[0].pressure == 12
    assert changed.contact[0].friction_coefficient == 0.4
    assert changed.mesh[0].parameters == own.mesh[0].parameters
    assert tomllib.loads(scene["said"][0])["mesh"]["file"] == "own.geo"


def test_the_displacement_of_a_quick_answer_is_that_of_a_run(own, alone):
    study = alone(own)
    with refused("no_quick_answer_yet"):
        study.displacement()
    study.quantities({"load.0.pressure": 11})
    quick = study.displacement()
    study.solve({"load.0.pressure": 11})
    assert np.allclose(quick, study.run.solution.displacement, atol=1e-12)


def test_the_latest_of_many_requests_is_answered(own, alone):
    exploration = Exploration(alone(own), {"load.0.pressure": (5, 15)})

    async def conversation(page):
        await page.until("answer", 0)
        for number in range(1, 31):
            await page.ask(number, "follow", load__0__pressure=5 + number / 3)
        last = await page.until("answer", 30)
        return last, [each["number"] for each in page.seen if each["kind"] == "answer"]

    last, numbers = talk(exploration, conversation)
    assert row(last, "normal force")[0] == "30"
    assert numbers == sorted(numbers)
    assert len(numbers) < 31


def test_a_drag_stops_a_whole_answer_between_its_load_steps(alone):
    """It has no answer of its own, and none follows the newer one."""
    scene = dataclasses.replace(HUNG, steps=Steps(number=200))
    exploration = Exploration(alone(scene, square()), {"load.0.traction.0": (1, 20)})

    async def conversation(page):
        await page.until("answer", 0)
        await page.ask(1, "solve", load__0__traction__0=5)
        await asyncio.sleep(0.3)
        await page.ask(2, "follow", load__0__traction__0=6)
        await page.until("answer", 2)
        return [each["number"] for each in page.seen if each["kind"] == "answer"]

    assert talk(exploration, conversation) == [0, 2]


def test_without_equilibrium_the_page_says_so_and_goes_on(own, alone):
    """Pulled by more than friction can hold there is none; a smaller load has one again."""
    exploration = Exploration(alone(own), {"load.1.traction.0": (1, 60)})

    async def conversation(page):
        await page.until("answer", 0)
        await page.ask(1, "follow", load__1__traction__0=50)
        quick = await page.until("nothing", 1)
        await page.ask(2, "solve", load__1__traction__0=50)
        whole = await page.until("nothing", 2)
        await page.ask(3, "follow", load__1__traction__0=4)
        return quick, whole, await page.until("answer", 3)

    quick, whole, after = talk(exploration, conversation)
    for answer in (quick, whole):
        assert "equilibrium" in answer["said"][0]
    assert row(after, "friction force")[0] == "-4, 0"


def test_no_convergence_is_said_in_words(own, alone):
    few = dataclasses.replace(own, solver=dataclasses.replace(own.solver, max_iterations=1))
    explorer, changes = Explorer(alone(few)), {"load.0.pressure": 12}
    for found in (explorer.follow(changes), explorer.solve(changes, lambda: False)):
        (message,) = found
        assert message.kind == "nothing"
        assert len(message.header["said"][0]) > 20


def test_where_a_scene_as_it_is_has_no_answer_the_page_ends(own, alone):
    few = dataclasses.replace(own, solver=dataclasses.replace(own.solver, max_iterations=1))
    exploration = Exploration(alone(few))
    with refused("newton_steps_used_up", NotConvergedError):
        exploration.serve()
    exploration.close()


def test_a_followed_branch_is_named(alone):
    """Beyond the limit of uniqueness a dragged answer follows the last one."""
    scene = load_scene(ROOT / "demos" / "winkler.toml")
    exploration = Exploration(alone(scene), {"load.0.pressure": (9, 11)})

    async def conversation(page):
        first = await page.until("answer", 0)
        await page.ask(1, "follow", load__0__pressure=10.1)
        return first, await page.until("answer", 1)

    first, second = talk(exploration, conversation)
    assert (first["start"], second["start"]) == ("cold", "followed")
    assert any("a separate run may find another one" in words for words in second["said"])


def test_another_body_is_drawn_anew(alone):
    """A material that changes, and a mesh."""
    scene = load_scene(ROOT / "demos" / "slab.toml")
    keys = ["mesh.parameters.cells_along=8:16", "material.youngs_modulus=500:2000"]
    exploration = Exploration(alone(scene), keys)
    assert [one.makes_anew for one in exploration.keys] == [True, True]
    names = {"mesh__0__parameters__cells_along": 8.0, "material__0__youngs_modulus": 2000.0}

    async def conversation(page):
        shape = await page.until("shape")
        await page.until("answer", 0)
        await page.ask(1, "solve", **names)
        other = await page.until("shape", 1)
        return shape, other, await page.until("answer", 1)

    shape, other, answer = talk(exploration, conversation)
    assert other["arrays"]["points"].size < shape["arrays"]["points"].size
    assert answer["arrays"]["displacement"].size == other["arrays"]["points"].size
    assert row(answer, "max contact pressure")[0] == "300"


def test_several_contacts_in_space(alone):
    """A cube between two planes: each contact has its map, and the forces are opposite."""
    scene = Scene(
        kinematics="3D",
        material=Material(1000, 0.0),
        discretisation=Discretisation(1),
        support=(Support("x0", {"x": 0}), Support("y0", {"y": 0})),
        contact=(
            Contact("z0", name="below", obstacle=Obstacle(shape="plane", position=(0, 0, 0))),
            Contact(
                "z1",
                name="above",
                obstacle=Obstacle(
                    shape="plane", position=(0, 0, 1), normal=(0, 0, -1), indentation=0.01
                ),
            ),
        ),
    )
    body = box_body((3, 3, 3), (1, 1, 1), comm=MPI.COMM_SELF)
    exploration = Exploration(alone(scene, body), {"contact.1.obstacle.indentation": (0.005, 0.02)})

    async def conversation(page):
        shape = await page.until("shape")
        await page.until("answer", 0)
        await page.ask(1, "solve", contact__1__obstacle__indentation=0.02)
        return shape, await page.until("answer", 1)

    shape, answer = talk(exploration, conversation)
    assert [one["name"] for one in shape["contacts"]] == ["below", "above"]
    assert [one["axes"] for one in shape["contacts"]] == [["x", "y"]] * 2
    for number in (0, 1):  # σ = E ε, as ν = 0
        assert answer["arrays"][f"{number}.pressure"] == pytest.approx(20, rel=2e-3)
        assert len(shape["arrays"][f"{number}.pieces"]) == 3 * 2 * 9
    assert float(row(answer, "normal force of above")[0]) == pytest.approx(20, rel=2e-3)
    stands = shape["arrays"]["1.places"] + answer["arrays"]["1.obstacle"]
    assert stands.reshape(-1, 3)[:, 2] == pytest.approx(0.98, abs=1e-5)


def test_pages_that_ask_for_what_they_must_not_are_refused_and_nothing_is_solved(own, alone):
    exploration = Exploration(alone(own), {"load.0.pressure": (5, 15)})

    async def conversation(page):
        await page.until("answer", 0)
        await page.ask(1, "follow", load__1__traction__0=1)
        first = await page.until("refused")
        await page.ask(2, "solve", load__0__pressure=16)
        second = await page.until("refused")
        await page.ask(3, "follow", load__0__pressure=6)
        await page.until("answer", 3)
        return first, second, page.seen

    first, second, seen = talk(exploration, conversation)
    says("key_is_not_shown", first["said"][0])
    says("pressure_beyond_its_range", second["said"][0])
    assert [each["number"] for each in seen if each["kind"] == "answer"] == [0, 3]


def test_notebooks_show_a_frame(own, alone):
    page = alone(own).explore({"load.0.pressure": (5, 15)})
    try:
        assert page._repr_html_().startswith(f'<iframe src="{page.address}"')
        assert page.address in repr(page)
    finally:
        page.close()


def test_in_a_notebook_s_loop_its_thread_answers(own, alone):
    """As in a kernel, whose loop runs between the cells: nobody calls ``serve``."""
    from tornado.websocket import websocket_connect

    from tests.explore.talking import Page

    async def cell():
        exploration = alone(own).explore({"load.0.pressure": (5, 15)})
        socket = await websocket_connect(
            exploration.address.replace("http", "ws", 1) + "messages", max_message_size=2**26
        )
        page = Page(socket)
        await page.until("answer", 0)
        await page.ask(1, "follow", load__0__pressure=6)
        found = await page.until("answer", 1)
        exploration.close()
        return found

    assert row(asyncio.run(cell()), "normal force")[0] == "12"
