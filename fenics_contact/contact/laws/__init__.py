"""Laws across a contact (``normal``) and along it (``friction``), a file each.

Each says its energy in UFL once, and answers for itself whatever other rooms ask of it. The paper's
(1.6), (1.8), (2.6) to (2.8) and (4.1).
"""
