"""A page without a browser: asks, and reads what comes."""

from __future__ import annotations

import asyncio
import json
import threading

import numpy as np
from tornado.websocket import websocket_connect


def decoded(packed):
    """A message as the page's script takes it apart."""
    length = int.from_bytes(packed[:4], "little")
    head = json.loads(packed[4 : 4 + length])
    found, at = {}, 4 + length
    for name, letter, size in head.pop("arrays"):
        found[name] = np.frombuffer(packed, {"f": "<f4", "i": "<i4"}[letter], size, at)
        at += 4 * size
    assert at == len(packed)
    return head | {"arrays": found}


class Page:
    """An open page.

    Attributes:
        seen: All messages so far.
    """

    def __init__(self, socket):
        self._socket, self.seen = socket, []

    async def ask(self, number, kind, **values):
        """Send a request; dots of keys are ``__``."""
        named = {key.replace("__", "."): value for key, value in values.items()}
        request = {"number": number, "kind": kind, "values": named}
        await self._socket.write_message(json.dumps(request))

    async def until(self, kind, number=None):
        """The next message of a kind, and number, if one is given."""
        while True:
            packed = await asyncio.wait_for(self._socket.read_message(), 120)
            assert packed is not None, "the page was closed"
            self.seen.append(decoded(packed))
            found = self.seen[-1]
            if found["kind"] == kind and number in (None, found.get("number")):
                return found


def talk(exploration, conversation):
    """Have a page talk with an exploration, which this thread answers.

    Args:
        exploration: That is not served yet.
        conversation: Takes a page; a coroutine function.

    Returns:
        What the conversation returns.
    """
    result, ended = {}, threading.Event()

    async def open_page():
        address = exploration.address.replace("http", "ws", 1) + "messages"
        socket = await websocket_connect(address, max_message_size=2**26)
        result["value"] = await conversation(Page(socket))
        socket.close()

    def run():
        try:
            asyncio.run(open_page())
        except BaseException as error:
            result["error"] = error
        finally:
            ended.set()

    threading.Thread(target=run, daemon=True).start()
    try:
        exploration.serve(ended.is_set)
    finally:
        exploration.close()
    if "error" in result:
        raise result["error"]
    return result["value"]


def row(message, name):
    """Value, bar and unit of a quantity in the table of an answer."""
    (found,) = [cells for head, *cells in message["rows"] if head == name]
    return found
