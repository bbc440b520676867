"""A scene that is explored: its page, its server and the thread that answers."""

from __future__ import annotations

import asyncio
import contextlib
import html
import itertools
import json
import logging
from collections.abc import Callable, Iterator, Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

from markupsafe import Markup

from fenics_contact.common import timings
from fenics_contact.common.errors import InputError
from fenics_contact.common.failures import BUG, explain
from fenics_contact.common.wording import one_line
from fenics_contact.explore.explorer import Explorer, with_number
from fenics_contact.explore.keys import MovedKey, moved_keys
from fenics_contact.explore.messages import Exchange, Message, Request, read_request, said
from fenics_contact.explore.server import Access, File, Server, Site, new_token
from fenics_contact.report import page as report_page
from fenics_contact.report.drawing.style import COLOURS
from fenics_contact.report.gallery import require
from fenics_contact.report.page.templates import render
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.writing import text_beside
from fenics_contact.simulation.studies.study import Study

_SCRIPT, _STYLE = "text/javascript; charset=utf-8", "text/css; charset=utf-8"


def files_of(scene: Scene, keys: Sequence[MovedKey]) -> dict[str, File]:
    """Name → file of the page, which has no name itself.

    Args:
        scene: What is explored.
        keys: What is moved.

    Raises:
        InputError: The model is in space, and plotly is missing.
    """
    own, report = resources.files(__package__), resources.files(report_page.__name__)
    found = {
        "": File(_page(scene, keys).encode(), "text/html; charset=utf-8"),
        "drawing.js": File(own.joinpath("drawing.js").read_bytes(), _SCRIPT),
        "explore.js": File(own.joinpath("explore.js").read_bytes(), _SCRIPT),
        "explore.css": File(own.joinpath("explore.css").read_bytes(), _STYLE),
        "report.css": File(report.joinpath("report.css").read_bytes(), _STYLE),
    }
    if scene.dimension == 3:  # what is flat is drawn without it
        require("plotly")
        from plotly.offline import get_plotlyjs

        found["plotly.js"] = File(get_plotlyjs().encode(), _SCRIPT)
    return found


def _page(scene: Scene, keys: Sequence[MovedKey]) -> str:
    grouped = itertools.groupby(keys, lambda one: one.number.of or "scene")
    data = {
        "keys": {
            one.key: {
                "low": one.low,
                "high": one.high,
                "start": one.start,
                "whole": one.number.is_whole,
                "anew": one.makes_anew,
            }
            for one in keys
        },
        "units": _units(scene),
        "colours": [COLOURS[word] for word in ("OPEN", "STICK", "SLIP")],
    }
    text = json.dumps(data, allow_nan=False).replace("<", "\\u003c")
    return render(
        "explore.html",
        title=one_line(scene.title or "fenics-contact explore"),
        sheets=["report.css", "explore.css"],
        groups=[(group, list(found)) for group, found in grouped],
        units={one.key: one.number.unit(scene) for one in keys},
        notes=_notes(scene, keys),
        in_space=scene.dimension == 3,
        data=Markup(text),
    )


def _units(scene: Scene) -> dict[str, str]:
    """Return the units of lengths and stresses; empty in a scene without units."""
    names = scene.unit_names
    measured = ("length", "stress")
    return {each: "" if names is None else names.of(each) for each in measured}


def _notes(scene: Scene, keys: Sequence[MovedKey]) -> list[str]:
    """Return remarks on all answers."""
    notes = []
    if scene.load_steps.several:
        notes.append(
            f"Of several load steps, the last is shown, at time {scene.load_steps.last:g}."
        )
    anew = [one.key for one in keys if one.makes_anew]
    if anew:
        notes.append(
            f"The body is made anew for {', '.join(anew)}: the answer comes when you let go."
        )
    return notes


LOOPBACK = "127.0.0.1"
_EVERYWHERE = ("0.0.0.0", "::", "")
_WAIT = 0.2  # seconds between looks whether to end
_HEIGHT = 900  # pixels in a notebook


class Exploration:
    """A page on which numbers of a scene are moved, and what answers it.

    The page is there at once. Its requests are answered by the thread that calls ``serve``; in a
    notebook, whose own loop runs between the cells, by the thread that made it.

    Attributes:
        address: The page's link, with a token that nobody else knows.
        keys: What is moved on it.
        is_local: Whether it can be reached from this machine only.

    Args:
        study: What is explored; on one rank. Nothing else may ask it meanwhile from another thread.
        vary: What is moved: ``KEY=LOW:HIGH`` each, or key → (low, high); chosen by default.
        host: Address to listen at.
        port: Port, 0 for a free one.
        beside: Folder that the text of a changed scene is for; by default the present one.
        in_frames: Whether the page may be shown inside other pages.

    Raises:
        InputError: There are several ranks, a key or a range is none, nothing can listen there, or
            plotly is missing for a model in space.
    """

    def __init__(
        self,
        study: Study,
        vary: Sequence[str] | Mapping[str, Any] = (),
        host: str = LOOPBACK,
        port: int = 0,
        beside: Path | None = None,
        in_frames: bool = False,
    ) -> None:
        if study.comm.size > 1:
            raise InputError(
                f"explore answers on one rank, and there are {study.comm.size}: start it without "
                "mpirun"
            )
        self.keys = moved_keys(study, vary)
        self._study, self._beside = study, (beside or Path.cwd()).resolve()
        self._explorer = Explorer(study)
        self._greeting = [said("progress", "making ready")]
        self._has_begun = False
        self._exchange = Exchange(self._call_soon)
        self._loop = _own_loop()
        token = new_token()
        access = Access(host, token)
        files = files_of(study.scene, self.keys)
        site = Site(access, files, self._greet, self._hear, self._exchange.forget, in_frames)
        self._server = Server(site, host, port)
        shown = LOOPBACK if host in _EVERYWHERE else f"[{host}]" if ":" in host else host
        self.address = f"http://{shown}:{self._server.port}/{token}/"
        self.is_local = access.is_local
        if self._loop is not None:
            # Cells go on, so there the page alone says why there is no answer.
            self._loop.call_soon(self._begin, self._explorer.follow)

    def serve(self, until: Callable[[], bool] = lambda: False) -> None:
        """Answer the page until Ctrl-C; by one thread only.

        Args:
            until: Whether to end, asked now and then.

        Raises:
            InputError: The scene as it is has no equilibrium.
            NotConvergedError: It has no answer.
            KeyboardInterrupt: Ctrl-C was pressed.
            MachineError: The machine failed.
        """
        self._begin(self._explorer.begin)
        while not until():
            found = self._exchange.take(_WAIT)
            if found is not None:
                self._answer(*found)

    def close(self) -> None:
        """End the page; the study stays."""
        self._loop = None
        self._server.close()

    def _repr_html_(self) -> str:
        """Return the HTML that notebooks show."""
        return (
            f'<iframe src="{html.escape(self.address)}" width="100%" height="{_HEIGHT}" '
            f'style="border: 0" title="{html.escape(self._study.scene.title or "explore")}" '
            'allow="clipboard-write"></iframe>'
        )

    def __repr__(self) -> str:
        return f"<Exploration at {self.address}>"

    def _greet(self) -> list[Message]:
        """To a page that was opened: how far all is, or where it begins."""
        return self._greeting

    def _begin(self, answer: Callable[[Mapping[str, Any]], Iterator[Message]]) -> None:
        """Find where pages begin, whether one is there or not."""
        if self._has_begun:
            return
        self._has_begun = True
        start = {one.key: one.taken(one.start) for one in self.keys}
        found = []
        with self._failing(), self._telling():
            for message in answer(start):
                found.append(with_number(message, 0))
                self._server.send_all(found[-1])
        self._greeting = found

    def _hear(self, page: int, text: str | bytes) -> list[Message]:
        """To a page that asks; by the thread that serves."""
        try:
            request = read_request(text, self.keys)
        except ValueError as error:
            return [said("refused", str(error))]
        if request.kind == "scene":
            return [self._scene_text(request)]
        self._exchange.put(page, request)
        return []

    def _scene_text(self, request: Request) -> Message:
        """The changed scene as TOML."""
        try:
            text = text_beside(self._study.changed(request.changes), self._beside)
        except InputError as error:
            return said("nothing", str(error), number=request.number)
        return said("scene", text, number=request.number)

    def _answer(self, page: int, request: Request) -> None:
        """Solve what a page asks for, and send it what comes out."""
        with self._failing():
            for message in self._answers(page, request):
                self._server.send(page, with_number(message, request.number))

    def _answers(self, page: int, request: Request) -> Iterator[Message]:
        if request.kind == "follow":
            return self._explorer.follow(request.changes)
        return self._explorer.solve(request.changes, lambda: self._exchange.has_newer(page))

    @contextlib.contextmanager
    def _failing(self) -> Iterator[None]:
        """Have the pages told what ends the program."""
        try:
            yield
        except BaseException as error:
            code, words = explain(error)
            self._server.send_all(said("ended", words.splitlines()[0] if code == BUG else words))
            raise

    @contextlib.contextmanager
    def _telling(self) -> Iterator[None]:
        """Have the pages told what is being done, until the first answer."""

        def tell(words: str) -> None:
            self._greeting = [said("progress", words)]
            self._server.send_all(self._greeting[0])

        listener, level = _Listener(tell), timings.logger.level
        timings.logger.addHandler(listener)
        timings.logger.setLevel(logging.DEBUG)
        try:
            yield
        finally:
            timings.logger.removeHandler(listener)
            timings.logger.setLevel(level)

    def _call_soon(self) -> None:
        """Have a notebook's thread answer when it is free."""
        loop = self._loop
        if loop is not None:
            with contextlib.suppress(RuntimeError):  # it has ended
                loop.call_soon_threadsafe(self._answer_waiting)

    def _answer_waiting(self) -> None:
        found = self._exchange.take()
        if found is not None:
            self._answer(*found)


class _Listener(logging.Handler):
    """Passes phases on."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        super().__init__(logging.DEBUG)
        self._tell = tell

    def emit(self, record: logging.LogRecord) -> None:
        """One of them."""
        self._tell(record.getMessage())


def _own_loop() -> asyncio.AbstractEventLoop | None:
    """The loop that runs in this thread, as in a notebook; None elsewhere."""
    try:
        return asyncio.get_running_loop()
    except RuntimeError:
        return None
