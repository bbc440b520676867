"""Quantities of the whole model from those of its contacts: how, and in which order."""

from fenics_contact.evaluate.quantities import of_all_contacts

SUMS = ("contact_area", "stick_area", "slip_area", "friction_work", "penalty_energy")
LARGEST = ("max_contact_pressure", "max_penetration", "max_slip")
ONLY = ("normal_force", "pressure_integral", "friction_force", "contact_force")
WORN = ("worn_volume", "max_wear_depth")


def a_contact(value, *more):
    """As an evaluation has them: its own order differs from that of the whole model."""
    names = (*ONLY, "max_contact_pressure", "contact_area", "stick_area", "slip_area")
    names += ("max_penetration", "max_slip", "friction_work", "penalty_energy")
    return dict.fromkeys((*names, *more), value)


def test_of_one_contact_in_the_order_of_columns():
    found = of_all_contacts([a_contact(2.0, "contact_radius", "stick_radius", "indentation")])
    radii = ("contact_radius", "stick_radius", "indentation")
    assert list(found) == [*ONLY, *LARGEST, *SUMS, *radii]
    assert set(found.values()) == {2.0}


def test_of_two_contacts_of_which_one_wears_and_one_has_an_obstacle():
    found = of_all_contacts([a_contact(2.0, *WORN), a_contact(3.0, "indentation")])
    assert list(found) == [*ONLY, *LARGEST, *SUMS, *WORN, "indentation"]
    assert all(found[name] is None for name in ONLY)
    assert all(found[name] == 3.0 for name in (*LARGEST, "indentation"))
    assert all(found[name] == 5.0 for name in SUMS)
    assert all(found[name] == 2.0 for name in WORN)


def test_several_obstacles_have_no_indentation_together():
    assert "indentation" not in of_all_contacts([a_contact(1.0, "indentation")] * 2)


def test_without_contacts():
    found = of_all_contacts([])
    assert all(found[name] is None for name in ONLY)
    assert all(found[name] == 0.0 for name in (*LARGEST, *SUMS))
