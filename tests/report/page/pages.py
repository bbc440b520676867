"""The page of a result, without pictures."""

from __future__ import annotations

from typing import Any

from markupsafe import Markup

from fenics_contact.report.page.page import Content, page


def page_of(result: dict[str, Any], scene: str = "", keeps_scene: bool = True) -> str:
    return page(Content("folder", {"scene": scene} | result, keeps_scene, [], [], Markup()))
