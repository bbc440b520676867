"""Who may use the page: whoever has its link, from pages of its own address only."""

from __future__ import annotations

import hmac
import secrets
from ipaddress import ip_address
from urllib.parse import urlsplit

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
