"""A real browser without a network, for pages of files.

Chromium and chromedriver are those on PATH, and selenium is theirs to drive. Where one is missing
tests are skipped, or fail where the environment has FENICS_CONTACT_BROWSER=required.
"""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

WINDOW = (1280, 900)
# Of the window's own, without the machine's graphics, and with no address that can be reached but
# that of this machine.
_OPTIONS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
    f"--window-size={WINDOW[0]},{WINDOW[1]}",
)
_WORTH_KNOWING = ("WARNING", "SEVERE")


class Browser:
    """A window of Chromium, and what its console has said.

    Attributes:
        driver: Selenium's.
        messages: Level and text of what the console said of level warning and above.
    """

    def __init__(self, driver) -> None:
        self.driver = driver
        self.messages: list[tuple[str, str]] = []

    def open(self, page: Path, width: int = WINDOW[0], dark: bool = False) -> None:
        """Show the page of a file in a window so many pixels wide."""
        size = {"width": width, "height": WINDOW[1], "deviceScaleFactor": 1}
        self._tell("Emulation.setDeviceMetricsOverride", size | {"mobile": width < 600})
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self._tell("Emulation.setEmulatedMedia", {"features": [scheme]})
        self.driver.get(page.resolve().as_uri())

    def _tell(self, what: str, values: dict) -> None:
        self.driver.execute_cdp_cmd(what, values)

    def errors(self) -> list[str]:
        """Errors that the console has told of since the last time."""
        entries = self.driver.get_log("browser")
        found = [(e["level"], e["message"]) for e in entries if e["level"] in _WORTH_KNOWING]
        self.messages += found
        return [message for level, message in found if level == "SEVERE"]


def _missing() -> str:
    """What there is not to drive a browser with."""
    try:
        import selenium  # noqa: F401
    except ImportError:
        return "selenium"
    return next((name for name in ("chromium", "chromedriver") if not shutil.which(name)), "")


@pytest.fixture(scope="session")
def _window(tmp_path_factory):
    missing = _missing()
    if missing:
        if os.environ.get("FENICS_CONTACT_BROWSER") == "required":
            pytest.fail(f"{missing} is missing, and FENICS_CONTACT_BROWSER=required")
        pytest.skip(f"{missing} is missing")
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    profile = tmp_path_factory.mktemp("profile")
    for option in (*_OPTIONS, f"--user-data-dir={profile}"):
        options.add_argument(option)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    service = webdriver.ChromeService(shutil.which("chromedriver"))
    driver = webdriver.Chrome(options=options, service=service)
    driver.set_script_timeout(60)
    yield driver
    driver.quit()


@pytest.fixture
def browser(_window):
    """A browser; the test fails if a page of it has had an error."""
    found = Browser(_window)
    found.errors()  # of pages before
    yield found
    assert found.errors() == []
