"""The page of a result, without pictures."""

from __future__ import annotations

from typing import Any

from markupsafe import Markup

from fenics_contact.report.page.page import Content, page
from tests.records import made_run


def page_of(result: dict[str, Any], scene: str = "", keeps_scene: bool = True) -> str:
    record = made_run({"scene": scene} | result)
    return page(Content("folder", record, keeps_scene, [], [], Markup()))
