"""Values with as many figures as their bars leave sure, and the lines that matter most."""

import numpy as np
import pytest

from fenics_contact.results.quantities import headlines
from fenics_contact.results.rounding import rounded, sizes_of
from tests.records import made_result


def row(total):
    return {"mesh": total, "total": total}


@pytest.mark.parametrize(
    ("value", "total", "said", "bar"),
    [
        (4246.48, 4.7, "4246", "5"),
        (4246.48, 4.0, "4246", "4"),
        (4246.48, 1.2, "4246.5", "1.2"),
        (4246.48, 530.0, "4200", "600"),
        (268.154, 0.54, "268.2", "0.6"),
        (0.0, 0.5, "0", "0.5"),
        (-0.04, 5.0, "0", "5"),
        (9.96, 0.96, "10.0", "1.0"),
        (1.1952e-05, 1.2e-05, "1.2e-05", "1.2e-05"),
        (3.2e7, 4.5e3, "3.2000e+07", "5e+03"),
        ([209.9742, -1e-5], 1.6e-3, "209.9742, 0", "0.0016"),
        (1.0, 3.7e-15, "1", ""),  # given: what is left is round-off
        (1.23456789, 0.0, "1.23457", ""),
        (1.23456789, None, "1.23457", "?"),
    ],
)
def test_a_value_has_the_figures_that_its_bar_leaves(value, total, said, bar):
    assert rounded(value, row(total)) == (said, bar)
    assert rounded(value, None)[1] == "?"


def test_a_rounded_bar_is_never_shorter_and_covers_the_rounded_value():
    """At most a quarter and half a figure longer, for any value and bar."""
    random = np.random.default_rng(5)
    for value, total in 10.0 ** random.uniform(-8, 8, (2000, 2)):
        said, bar = (float(words or 0) for words in rounded(value, row(total)))
        if total <= 1e-8 * value:
            continue
        assert total * (1 - 1e-6) <= bar <= 1.3 * total
        assert abs(said - value) <= 0.51 * bar


def test_forces_that_cancel_are_none():
    """Where others act, what round-off leaves is 0; where nothing acts it is what it is."""
    assert rounded([-1.5e-11, 27.0], None, 30.0) == ("0, 27", "?")
    assert rounded([-1.5e-11, 0.0], row(2e-11), 30.0) == ("0, 0", "")
    assert rounded([-1.5e-11, 0.0], row(2e-12), 0.0)[1] == "2.0e-12"


QUANTITIES = {
    "normal_force": 200.0,
    "pressure_integral": 200.0,
    "friction_force": [30.0, 40.0],
    "max_contact_pressure": 12.345678,
    "max_slip": 0.25,
    "friction_work": 2.0,
    "slip_share": 0.5,
}


def contact(**changes):
    return {
        "name": "lug",
        "law": "incremental",
        "quantities": QUANTITIES,
        "parameters": {"friction_coefficient": 0.5},
        "errors": {"normal_force": row(4.7), "max_contact_pressure": row(None)},
    } | changes


def result(*contacts, **changes):
    given = {"converged": True, "passed": True, "quantities": {"friction_work": 2.0}}
    return made_result(**given | {"contacts": list(contacts)} | changes)


def test_a_contact_says_what_it_carries_and_what_friction_uses_of_its_limit():
    lines = headlines(result(contact(), errors={"friction_work": row(0.1)}))
    assert lines == [
        "Contact 'lug': presses with 200 ± 5, friction 50 ± ? (50 % of its limit), "
        "peak pressure 12.3457 ± ?, slips by up to 0.25 ± ?.",
        "Friction dissipated 2.00 ± 0.10.",
    ]


def test_what_does_not_apply_is_left_out():
    plain = contact(law="none", errors={})
    plain["quantities"] = {k: v for k, v in QUANTITIES.items() if k != "slip_share"}
    assert headlines(result(plain)) == ["Contact 'lug': presses with 200, peak pressure 12.3457."]
    around = contact(quantities=QUANTITIES | {"normal_force": None, "friction_force": [0.0, 0.0]})
    assert headlines(result(around))[0].startswith(
        "Contact 'lug': presses with 200 ± ?, friction at 50 % of its limit, peak"
    )
    wedged = contact(quantities=QUANTITIES | {"slip_share": None})
    assert "friction 50 ± ? (- of its limit), peak" in headlines(result(wedged))[0]
    earlier = {k: v for k, v in QUANTITIES.items() if k != "slip_share"}  # as files had it
    assert "limit" not in headlines(result(contact(quantities=earlier)))[0]
    assert headlines(result(contact(), converged=False)) == []


def test_the_largest_force_of_all_contacts_counts():
    found = result(contact(), contact(name="other", quantities={"contact_force": [0.0, -900.0]}))
    assert sizes_of(found.quantities, found.contacts)["force"] == 900.0


def test_what_is_zero_by_symmetry_is_no_estimate():
    """Beside what else is there: forces, energies, and what these move."""
    found = QUANTITIES | {"friction_force": [8e-10, 0.0], "max_slip": 1e-18, "friction_work": 1e-16}
    errors = {"friction_force": row(4e-9), "max_slip": row(6e-18), "friction_work": row(4e-15)}
    found["slip_share"] = 1e-12
    every = found | {"strain_energy": 0.5, "normal_force": 3.0, "pressure_integral": 3.0}
    given = {"quantities": every, "errors": errors}
    stuck = result(contact(**given), **given)
    assert headlines(stuck) == [
        "Contact 'lug': presses with 3 ± ?, peak pressure 12.3457 ± ?.",
        "Friction dissipated 0.",
    ]
    assert "friction force: 0, 0\n" in f"{stuck!r}\n"
    assert sizes_of(every, [])["length"] == pytest.approx(0.5 / 3)
    slipping = every | {"max_slip": 1e-6}
    assert "slips by up to 1e-06" in headlines(result(contact(quantities=slipping)))[0]
