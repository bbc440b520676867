"""Results made up for a purpose: records of a few keys, the others filled in."""

from typing import Any

from pydantic import TypeAdapter

from fenics_contact import Result
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.run import RunRecord

_CONTACT = {"name": "", "contact": "unilateral", "law": "none", "parameters": {}, "quantities": {}}
_STEP = {"load_factor": 1.0, "newton_iterations": 1, "outer_iterations": 0, "quantities": {}}
_RUN = {
    **{"title": "", "verdict": "", "scene": "", "converged": True, "passed": True},
    **{"contacts": [], "supports": [], "quantities": {}, "steps": [], "checks": {}},
    **{"timings": {"total": 1.0}, "versions": {}},
}
Content = dict[str, Any]


def _contact(content: Content) -> Content:
    """With what the laws of its names answer."""
    found = _CONTACT | content
    answers = {
        "pressure_is_given": found["contact"] == "prescribed",
        "is_rigid": found["contact"] in ("unilateral", "bonded"),
        "carries_shear": found["law"] != "none",
    }
    return {"answers": answers} | found


def made_contact(**content: Any) -> ContactRecord:
    return TypeAdapter(ContactRecord).validate_python(_contact(content))


def made_run(content: Content) -> RunRecord:
    """What a file of this content would hold."""
    model = {"kinematics": "plane strain", "contact_points": 0} | content.get("model", {})
    contacts = [_contact(contact) for contact in content.get("contacts", [])]
    steps = [_STEP | step for step in content.get("steps", [])]
    for step in steps:
        step["contacts"] = [_CONTACT | contact for contact in step.get("contacts", [])]
    filled = {"model": model, "contacts": contacts, "steps": steps}
    return TypeAdapter(RunRecord).validate_python(_RUN | content | filled)


def made_result(**content: Any) -> Result:
    """A result that has not been written; its checks are given as they are."""
    found = made_run({key: value for key, value in content.items() if key != "checks"})
    others = {key: value for key, value in vars(found).items() if key not in ("passed", "scene")}
    return Result(**others | {"checks": content.get("checks", {})})
