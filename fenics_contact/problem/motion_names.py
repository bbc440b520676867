"""Rigid motions that supports leave free, before contact: by name, with what may resist them."""

from __future__ import annotations

from typing import Any

import numpy as np

from fenics_contact.common.parallel import largest
from fenics_contact.problem.existence.friction_cones import contact_cones
from fenics_contact.problem.existence.rigid_slip import allowance
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions

# Jump of a motion, over its size, from which a contact resists it.
_RESISTS = 1e-9


def named_motions(problem: Problem, rigid: RigidMotions) -> list[dict[str, Any]]:
    """``model.rigid_motions`` of a result; collective.

    Returns:
        A row a motion: ``motion`` in words, ``bodies`` that take part, and ``resisted_by``: the
        contacts that may stop it once they touch.
    """
    rows = []
    motions = contact_cones(problem, rigid).aligned()[1] if rigid.count else np.zeros((0, 0))
    for motion in motions.T:
        resisted = []
        for contact in problem.contacts:
            if not contact.forces.terms:
                continue
            jumps = rigid.jumps(contact) @ motion
            across = contact.kinematics.normal(jumps)
            along = np.linalg.norm(contact.kinematics.tangential(jumps), axis=1)
            acts = contact.kinematics.reached | contact.normal.pressure_is_known
            size = allowance(contact.kinematics.facet_turn) * largest(problem.comm, along[acts])
            # Facets do not hold what a round surface does not.
            presses = contact.is_one_sided and largest(problem.comm, np.abs(across)[acts]) > size
            for word, sizes in (
                ("contact", np.abs(across) * presses),
                ("friction", along * contact.friction.has_friction),
            ):
                if largest(problem.comm, sizes[acts]) > _RESISTS:
                    resisted.append(f"{word} at '{contact.label}'")
        name, bodies = rigid.describe(motion), rigid.parts_moved(motion)
        rows.append({"motion": name, "bodies": bodies, "resisted_by": resisted})
    return rows
