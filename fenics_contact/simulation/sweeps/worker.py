"""A process of a sweep: a program of its own, on one rank, which solves the points it is given.

``processes`` starts it with the number of a socket as its argument. It never sees the MPI of the
process that started it, and ends when the socket is closed, be it that the other one was killed.
"""

import os
import pickle
import struct
import sys
import threading
from multiprocessing.connection import Connection
from pathlib import Path
from queue import SimpleQueue
from typing import Any

#: What messages of this process begin with: of memory, and of a point that is done.
NEEDS, FOUND = b"n", b"f"
_GONE = 130


def main() -> None:
    """Solve points until there are no more."""
    connection = Connection(int(sys.argv[1]))
    given: SimpleQueue[Any] = SimpleQueue()
    threading.Thread(target=_listen, args=(connection, given), daemon=True).start()

    from fenics_contact.contact.laws.allowed import allow_laws
    from fenics_contact.simulation.sweeps.answers import Answers

    for module in sys.argv[3:]:
        allow_laws(module)

    def need(memory: float) -> None:
        connection.send_bytes(NEEDS + struct.pack("d", memory))

    answers = Answers(Path(sys.argv[2]), need)
    while True:
        scene, digest = pickle.loads(given.get())
        _, packed = answers.answer(scene, digest)
        connection.send_bytes(FOUND + packed)


def _listen(connection: Connection, given: "SimpleQueue[Any]") -> None:
    """Take what comes, also while a point is solved, and end the process with the connection."""
    try:
        while True:
            given.put(connection.recv_bytes())
    except (EOFError, OSError):
        os._exit(_GONE)


if __name__ == "__main__":
    main()
