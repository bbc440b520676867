"""Names of quantities, as they stand in ``result.json`` and in scenes."""

from __future__ import annotations

NORMAL_FORCE = "normal_force"
PRESSURE_INTEGRAL = "pressure_integral"
FRICTION_FORCE = "friction_force"
CONTACT_FORCE = "contact_force"
REACTION = "reaction"
INDENTATION = "indentation"
MAX_CONTACT_PRESSURE = "max_contact_pressure"
MAX_PENETRATION = "max_penetration"
CONTACT_AREA = "contact_area"
STICK_AREA = "stick_area"
SLIP_AREA = "slip_area"
CONTACT_RADIUS = "contact_radius"
STICK_RADIUS = "stick_radius"
MAX_SLIP = "max_slip"
STRAIN_ENERGY = "strain_energy"
EXTERNAL_WORK = "external_work"
FRICTION_WORK = "friction_work"
PENALTY_ENERGY = "penalty_energy"
#: Begins the name of the displacement of a ``[[point]]``.
OF_POINTS = "displacement_"
