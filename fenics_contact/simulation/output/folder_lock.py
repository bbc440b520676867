"""A folder that one run, sweep or fit at a time writes to."""

from __future__ import annotations

import fcntl
import logging
import os
import weakref
from pathlib import Path

from fenics_contact.common.atomic_files import make_folder
from fenics_contact.common.errors import InputError

logger = logging.getLogger(__name__)


class FolderLock:
    """Keeps other runs and sweeps out of a folder; a process that ends, in any way, gives it up.

    The system keeps the lock, on the folder itself: nothing is left behind in it.

    Args:
        folder: That is written to; it need not be there yet.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._give_up: weakref.finalize[[int], FolderLock] | None = None

    def __enter__(self) -> FolderLock:
        return self

    def __exit__(self, *error: object) -> None:
        self.give_up()

    def take(self, make: bool = False) -> None:
        """Keep others out from now on, once the folder is there.

        Args:
            make: Whether to make the folder, if it is not.

        Raises:
            InputError: Another run, sweep or fit is at work there.
        """
        if make:
            make_folder(self._folder)
        if self._give_up is not None or not self._folder.is_dir():
            return
        opened = os.open(self._folder, os.O_RDONLY)
        try:
            fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(opened)
            raise InputError(
                f"'{self._folder}': another run, sweep or fit is at work there; wait until it has "
                "ended, or give another --out"
            ) from None
        except OSError as error:  # of file systems that have no locks
            logger.info("'%s' cannot be locked: %s", self._folder, error.strerror)
        self._give_up = weakref.finalize(self, os.close, opened)

    def give_up(self) -> None:
        """Let others in again."""
        if self._give_up is not None:
            self._give_up()
            self._give_up = None
