"""Serves the page to whoever has its link, and carries its messages, from a thread of its own."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import hmac
import itertools
import logging
import secrets
import threading
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from ipaddress import ip_address
from typing import Any
from urllib.parse import urlsplit

from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets
from tornado.web import Application, HTTPError, RequestHandler
from tornado.websocket import WebSocketClosedError, WebSocketHandler

from fenics_contact.common.errors import InputError
from fenics_contact.explore.messages import Message

_BYTES = 24  # of a token, which nobody can guess


def new_token() -> str:
    """A token at random for a link."""
    return secrets.token_urlsafe(_BYTES)


class Access:
    """Decides which requests are answered.

    A page of another site can have a browser send requests to this address, and can give this
    address a name of its own (DNS rebinding). So the name in a request has to be one that such a
    page cannot have: the name that the user gave, ``localhost``, or a number; and numbers of other
    machines only where the user wants to be reached from there.

    Args:
        host: The address that is listened at, as the user gave it.
        token: Of the link.
    """

    def __init__(self, host: str, token: str) -> None:
        self._host, self._token = host.strip("[]").lower(), token
        self.is_local = _is_loopback(self._host)

    def has_token(self, given: str) -> bool:
        """Whether a link's token is right, compared in a time that tells nothing."""
        return hmac.compare_digest(given.encode(), self._token.encode())

    def is_own_host(self, host: str | None) -> bool:
        """Whether the header Host of a request names this address."""
        name = _name_of(f"//{host}") if host else None
        if name is None:
            return False
        if name in ("localhost", self._host):
            return True
        try:
            address = ip_address(name)
        except ValueError:
            return False
        return address.is_loopback or not self.is_local

    def is_own_origin(self, origin: str, host: str | None) -> bool:
        """Whether a request comes from a page of the address that it goes to."""
        return self.is_own_host(host) and origin.lower() == f"http://{host}".lower()


def _name_of(address: str) -> str | None:
    """The name in an address, without its port; None of what is no address."""
    try:
        parts = urlsplit(address)
        _ = parts.port
    except ValueError:
        return None
    plain = not (parts.username or parts.path or parts.query or parts.fragment)
    return parts.hostname if plain else None


def _is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return False


# Of a request: a page sends a few numbers.
_MOST_BYTES = 2**16
_MOST_PAGES = 8
_PATIENCE = 5.0  # seconds for the thread to end
_REFUSED = (
    "This link is not valid: open the one that the program has printed, which is new each time."
)


@dataclass(frozen=True)
class File:
    """A part of the page.

    Attributes:
        content: Of the file.
        kind: Its media type.
    """

    content: bytes
    kind: str


@dataclass(frozen=True)
class Site:
    """The served page and its access.

    Attributes:
        access: Who may use it.
        files: Name in the link → file; the page itself has no name. Nothing else can be had.
        greeting: What a page is sent first.
        heard: Called with a page's number and what it sends; gives what to answer at once.
        left: Called with the number of a page that is closed.
        in_frames: Whether the page may be shown inside others, as of notebooks.
    """

    access: Access
    files: dict[str, File]
    greeting: Callable[[], list[Message]]
    heard: Callable[[int, str | bytes], list[Message]]
    left: Callable[[int], None]
    in_frames: bool


class Server:
    """The thread that serves; sockets are bound at once, so that errors are those of the caller.

    Attributes:
        port: That it listens at.

    Args:
        site: What is served.
        host: Address to listen at.
        port: Port, 0 for a free one.

    Raises:
        InputError: The address is none of this machine, or the port is taken.
    """

    def __init__(self, site: Site, host: str, port: int) -> None:
        try:
            self._sockets = bind_sockets(port, address=host)
        except OSError as error:
            raise InputError(_why(error, host, port)) from None
        self.port: int = self._sockets[0].getsockname()[1]
        self._site = site
        self._pages: dict[int, _Page] = {}
        self._loop: asyncio.AbstractEventLoop | None = None
        self._ready: Future[None] = Future()
        self._ended: asyncio.Event | None = None
        self._thread = threading.Thread(target=self._run, name="explore", daemon=True)
        self._thread.start()
        self._ready.result()

    def send(self, page: int, message: Message) -> None:
        """Send a message to a page, from any thread; nothing if it is closed."""
        self._call(self._deliver, page, message.packed())

    def send_all(self, message: Message) -> None:
        """Send a message to all pages."""
        self._call(self._deliver_to_all, message.packed())

    def close(self) -> None:
        """End the thread, and close all pages."""
        ended = self._ended
        if ended is not None:
            self._call(ended.set)
        self._thread.join(_PATIENCE)

    def _call(self, what: Callable[..., object], *values: object) -> None:
        """Have something called by the thread; nothing once it has ended."""
        with contextlib.suppress(RuntimeError):
            assert self._loop is not None
            self._loop.call_soon_threadsafe(what, *values)

    def _run(self) -> None:
        asyncio.run(self._serve())

    async def _serve(self) -> None:
        self._loop, self._ended = asyncio.get_running_loop(), asyncio.Event()
        # what browsers and others get wrong is none of the terminal's business
        logging.getLogger("tornado.general").addHandler(logging.NullHandler())
        values = {"site": self._site, "pages": self._pages, "numbers": itertools.count()}
        application = Application(
            [
                (r"/([^/]*)/messages", _Page, values),
                (r"/([^/]*)/(.*)", _Part, {"site": self._site}),
            ],
            default_handler_class=_Elsewhere,
            default_handler_args={"site": self._site},
            log_function=lambda handler: None,
            websocket_max_message_size=_MOST_BYTES,
            websocket_ping_interval=0,
        )
        server = HTTPServer(application, max_body_size=_MOST_BYTES, max_header_size=_MOST_BYTES)
        server.add_sockets(self._sockets)
        self._ready.set_result(None)
        await self._ended.wait()
        for page in list(self._pages.values()):
            page.close()
        server.stop()
        await server.close_all_connections()

    def _deliver(self, page: int, packed: bytes) -> None:
        if page in self._pages:
            self._pages[page].deliver(packed)

    def _deliver_to_all(self, packed: bytes) -> None:
        for page in list(self._pages.values()):
            page.deliver(packed)


def _why(error: OSError, host: str, port: int) -> str:
    """Why nothing can listen there."""
    if error.errno == errno.EADDRINUSE:
        return f"--port {port}: another program listens there; give another one, or none"
    if error.errno == errno.EACCES:
        return f"--port {port}: only the system's own programs may listen there; give one from 1024"
    return f"--host {host}: not an address of this machine"


class _Guarded(RequestHandler):
    """Refuses what is none of the page's own requests; says nothing of the machine."""

    def initialize(self, site: Site, **others: Any) -> None:
        self.site = site

    def prepare(self) -> None:
        """Before anything is done: who asks, from where, with which link."""
        host, origin = self.request.host, self.request.headers.get("Origin")
        if not self.site.access.is_own_host(self.request.headers.get("Host")):
            raise HTTPError(403, reason="Forbidden")
        if origin is not None and not self.site.access.is_own_origin(origin, host):
            raise HTTPError(403, reason="Forbidden")
        if not self.path_args or not self.site.access.has_token(self.path_args[0] or ""):
            raise HTTPError(403, reason="Forbidden")

    def set_default_headers(self) -> None:
        """Nothing from elsewhere, and nothing to elsewhere."""
        self.set_header("Server", "fenics-contact")
        self.set_header("Cache-Control", "no-store")
        self.set_header("X-Content-Type-Options", "nosniff")
        self.set_header("Referrer-Policy", "no-referrer")
        self.set_header("Cross-Origin-Resource-Policy", "same-origin")
        self.set_header("Content-Security-Policy", "default-src 'none'")

    def write_error(self, status_code: int, **others: Any) -> None:
        """One sentence."""
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish(_REFUSED if status_code == 403 else f"{status_code}: nothing here.")


class _Elsewhere(_Guarded):
    """Whatever has no place."""


class _Part(_Guarded):
    """The page, and the scripts that it is made of."""

    def get(self, token: str, name: str) -> None:
        """One of the files; nothing else can be named."""
        file = self.site.files.get(name)
        if file is None:
            raise HTTPError(404)
        self.set_header("Content-Type", file.kind)
        self.set_header("Content-Security-Policy", self._policy())
        self.finish(file.content)

    def _policy(self) -> str:
        """Scripts of this address alone; plotly writes styles into the page."""
        frames = "" if self.site.in_frames else "; frame-ancestors 'none'"
        return (
            "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
            f"img-src 'self' data: blob:; connect-src 'self' ws://{self.request.host}; "
            f"base-uri 'none'; form-action 'none'{frames}"
        )


class _Page(WebSocketHandler, _Guarded):
    """The messages between the program and one page that is open."""

    def initialize(self, site: Site, **others: Any) -> None:
        self.site, self._pages, self._numbers = site, others["pages"], others["numbers"]
        self._number = -1

    def check_origin(self, origin: str) -> bool:
        """Return whether the origin is the server's own, as for all other requests."""
        return self.site.access.is_own_origin(origin, self.request.host)

    def open(self, *arguments: str, **named: str) -> None:
        """A page is there."""
        if len(self._pages) >= _MOST_PAGES:
            self.close(1013, "too many pages")
            return
        self._number = next(self._numbers)
        self._pages[self._number] = self
        self.set_nodelay(True)
        for message in self.site.greeting():
            self.deliver(message.packed())

    def on_message(self, message: str | bytes) -> None:
        """The page asks for something."""
        for answer in self.site.heard(self._number, message):
            self.deliver(answer.packed())

    def on_close(self) -> None:
        """It has gone."""
        if self._pages.pop(self._number, None) is not None:
            self.site.left(self._number)

    def deliver(self, packed: bytes) -> None:
        """Send what is packed; nothing if the page has gone."""
        with contextlib.suppress(WebSocketClosedError):
            self.write_message(packed, binary=True)
