"""A result at a glance: short, and safe in a notebook."""

import re

import pytest

from fenics_contact import Result
from tests.records import made_result

QUANTITIES = {"normal_force": 2400.0, "friction_force": [209.97, 0.0], "strain_energy": 1.0}


def result(contacts=1, **changes):
    every = [
        {"name": f"<b>{n}</b>", "law": "static", "quantities": QUANTITIES} for n in range(contacts)
    ]
    errors = {"normal_force": {"total": 2.5}, "friction_force": {"total": None}}
    given = {
        "title": "<script>alert(1)</script> & co",
        "converged": True,
        "verdict": "Converged near '<top>'.",
        "model": {},
        "contacts": every,
        "quantities": QUANTITIES,
        "steps": [{}] * 100,
        "checks": {},
        "errors": errors,
    }
    return made_result(**given | changes)


def test_text_has_verdict_and_main_quantities_with_bars():
    assert repr(result()).splitlines() == [
        "Result: <script>alert(1)</script> & co",
        "Converged near '<top>'.",
        "normal force: 2400.0 ± 2.5",
        "friction force: 209.97, 0 ± ?",
    ]


def test_html_escapes_all_text_of_users():
    page = result(contacts=2)._repr_html_()
    assert "<script>" not in page and "<top>" not in page and "<b>" not in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt; &amp; co" in page
    assert "normal force of &lt;b&gt;0&lt;/b&gt;" in page
    opened, closed = (re.findall(rf"<{slash}(\w+)", page) for slash in ("", "/"))
    assert sorted(opened) == sorted(closed)
    assert "\x1b" not in result(title="\x1b[2J")._repr_html_() + repr(result(title="\x1b[2J"))


def test_many_contacts_are_cut_short():
    assert len(repr(result(contacts=500)).splitlines()) < 30


@pytest.mark.parametrize("show", [repr, Result._repr_html_])
def test_numbers_of_no_answer_are_not_shown(show):
    shown = show(result(converged=False, verdict="Not converged."))
    assert "Not converged." in shown and "2400" not in shown
