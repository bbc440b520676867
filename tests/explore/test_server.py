"""Who gets what from the page's server: with its link, from its own pages, at its own address."""

import asyncio
import http.client
import json
import socket
import threading

import pytest
from tornado.httpclient import HTTPClientError, HTTPRequest
from tornado.websocket import websocket_connect

from fenics_contact.explore.messages import said
from fenics_contact.explore.server import Access, File, Server, Site, new_token
from tests.messages import refused

pytestmark = pytest.mark.serial

TOKEN = new_token()


class Served:
    """A server, and what its pages have said."""

    def __init__(self, host="127.0.0.1", in_frames=False):
        self.heard, self.left = [], threading.Event()
        files = {"": File(b"<html>", "text/html"), "explore.js": File(b"1", "text/javascript")}
        site = Site(
            Access(host, TOKEN),
            files,
            lambda: [said("progress", "making ready")],
            self._hear,
            lambda page: self.left.set(),
            in_frames,
        )
        self.server = Server(site, host, 0)
        self.host = f"127.0.0.1:{self.server.port}"

    def _hear(self, page, text):
        self.heard.append(text)
        return [said("refused", "not this")]

    def get(self, path, method="GET", body=None, **headers):
        connection = http.client.HTTPConnection("127.0.0.1", self.server.port, timeout=20)
        connection.request(method, path, body, {name.title(): v for name, v in headers.items()})
        answer = connection.getresponse()
        content = answer.read()
        connection.close()
        return answer, content


@pytest.fixture(scope="module")
def served():
    found = Served()
    yield found
    found.server.close()


def test_the_page_and_its_headers(served):
    answer, content = served.get(f"/{TOKEN}/")
    assert (answer.status, content) == (200, b"<html>")
    policy = answer.headers["Content-Security-Policy"]
    assert policy.startswith("default-src 'none'; script-src 'self';")
    assert "unsafe-eval" not in policy and "frame-ancestors 'none'" in policy
    assert f"connect-src 'self' ws://{served.host};" in policy
    assert answer.headers["X-Content-Type-Options"] == "nosniff"
    assert answer.headers["Referrer-Policy"] == "no-referrer"
    assert answer.headers["Cache-Control"] == "no-store"
    assert "Tornado" not in answer.headers["Server"]
    assert served.get(f"/{TOKEN}/explore.js")[1] == b"1"


@pytest.mark.parametrize(
    "path",
    [
        "/",
        "/index.html",
        "//",
        f"/{TOKEN[:-1]}/",
        f"/{TOKEN}x/",
        f"/{TOKEN.swapcase()}/",
        "/%00/",
        "/%C3%BC/",
        f"/x/{TOKEN}/",
        "/wrong/explore.js",
        "/wrong/messages",
    ],
    # Not by the token, which is another one in each process that collects tests.
    ids=[
        *("root", "index", "empty", "short", "long", "case", "null", "letter", "behind"),
        *("script", "messages"),
    ],
)
def test_a_wrong_link_is_refused(served, path):
    answer, content = served.get(path)
    assert answer.status == 403
    assert b"link is not valid" in content


@pytest.mark.parametrize(
    "name",
    [
        "../../etc/passwd",
        "..%2f..%2fetc%2fpasswd",
        "%2e%2e/server.py",
        "/etc/passwd",
        "server.py",
        "explore.js/",
        "explore.js%00.css",
        "scene.toml",
    ],
)
def test_files_of_the_machine_cannot_be_had(served, name):
    answer, content = served.get(f"/{TOKEN}/{name}")
    assert answer.status == 404
    assert len(content) < 100


@pytest.mark.parametrize(
    "host",
    [
        *("evil.example", "evil.example:{port}", "127.0.0.1.evil.example", "192.168.0.1:{port}"),
        *("", "localhost.evil:{port}", "user@127.0.0.1:{port}", "127.0.0.1:99999999"),
        *("[::1", "127.1/x"),
    ],
)
def test_another_name_of_this_address_is_refused(served, host):
    """As by a page that has had its own name point here (DNS rebinding)."""
    answer, _ = served.get(f"/{TOKEN}/", host=host.format(port=served.server.port))
    assert answer.status in (400, 403)


@pytest.mark.parametrize("host", ["localhost", "localhost:1", "LOCALHOST", "127.0.0.1", "[::1]:80"])
def test_names_of_this_machine_are_accepted(served, host):
    assert served.get(f"/{TOKEN}/", host=host)[0].status == 200


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "https://{host}", "http://127.0.0.1:1", "file://"]
)
def test_pages_of_other_origins_are_refused(served, origin):
    origin = origin.format(host=served.host)
    assert served.get(f"/{TOKEN}/", origin=origin)[0].status == 403
    with pytest.raises(HTTPClientError) as error:
        asyncio.run(connected(served, origin))
    assert error.value.code == 403


def test_other_methods_and_large_requests_are_refused(served):
    for method in ("POST", "PUT", "DELETE", "PATCH"):
        assert served.get(f"/{TOKEN}/", method, b"x")[0].status == 405
    try:
        status = served.get(f"/{TOKEN}/", "POST", b"x" * 1_000_000)[0].status
    except (BrokenPipeError, ConnectionError, http.client.HTTPException):
        status = 400  # it hung up before all was sent
    assert status in (400, 413)
    assert served.get(f"/{TOKEN}/")[0].status == 200


async def connected(served, origin=None, token=TOKEN):
    request = HTTPRequest(
        f"ws://{served.host}/{token}/messages", headers={"Origin": origin} if origin else {}
    )
    return await websocket_connect(request)


def head(packed):
    length = int.from_bytes(packed[:4], "little")
    return json.loads(packed[4 : 4 + length])


def test_messages_go_both_ways_and_large_ones_end_it(served):
    async def talk():
        page = await connected(served, f"http://{served.host}")
        first = head(await page.read_message())
        await page.write_message("hello")
        second = head(await page.read_message())
        served.server.send_all(said("progress", "solving"))
        third = head(await page.read_message())
        served.left.clear()
        await page.write_message("x" * 100_000)
        return first, second, third, await page.read_message()

    first, second, third, last = asyncio.run(talk())
    assert (first["kind"], first["said"]) == ("progress", ["making ready"])
    assert second["kind"] == "refused"
    assert third["said"] == ["solving"]
    assert last is None
    assert served.heard[-1] == "hello"
    assert served.left.wait(20)


def test_a_wrong_token_opens_no_messages(served):
    with pytest.raises(HTTPClientError) as error:
        asyncio.run(connected(served, token="wrong"))
    assert error.value.code == 403


def test_only_so_many_pages_are_open(served):
    async def open_many():
        pages = [await connected(served) for _ in range(9)]
        refused = await pages[-1].read_message()
        assert head(await pages[0].read_message())["kind"] == "progress"
        for page in pages:
            page.close()
        return refused

    assert asyncio.run(open_many()) is None


def test_in_a_notebook_the_page_may_be_in_a_frame():
    served = Served(in_frames=True)
    policy = served.get(f"/{TOKEN}/")[0].headers["Content-Security-Policy"]
    served.server.close()
    assert "frame-ancestors" not in policy


def test_a_host_that_is_given_is_accepted_and_names_that_are_not_are_refused():
    """Numbers cannot be another site's; names can."""
    every = Access("0.0.0.0", TOKEN)
    assert not every.is_local
    assert every.is_own_host("192.168.0.7:9000") and every.is_own_host("localhost:9000")
    assert not every.is_own_host("evil.example:9000") and not every.is_own_host(None)
    named = Access("Bench.lan", TOKEN)
    assert named.is_own_host("bench.lan:80") and not named.is_own_host("bench.lan.evil:80")
    assert named.is_own_origin("http://bench.lan:80", "bench.lan:80")
    assert not named.is_own_origin("http://bench.lan:81", "bench.lan:80")
    assert Access("::1", TOKEN).is_local and Access("localhost", TOKEN).is_local


def test_tokens_are_long_and_differ():
    tokens = {new_token() for _ in range(100)}
    assert len(tokens) == 100
    assert min(map(len, tokens)) >= 32
    assert Access("127.0.0.1", TOKEN).has_token(TOKEN)
    assert not Access("127.0.0.1", TOKEN).has_token("")


def test_a_port_in_use_and_an_address_of_others_are_said(served):
    site = Site(
        Access("127.0.0.1", TOKEN), {}, list, lambda page, text: [], lambda page: None, False
    )
    with refused("port_in_use", port=served.server.port):
        Server(site, "127.0.0.1", served.server.port)
    for host in ("192.0.2.1", "no-such-host.invalid"):
        with refused("host_of_others", host=host):
            Server(site, host, 0)


def test_a_closed_server_lets_its_port_go():
    served = Served()
    port = served.server.port
    served.server.close()
    served.server.send_all(said("progress", "too late"))  # goes nowhere
    with socket.socket() as free:
        free.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        free.bind(("127.0.0.1", port))
