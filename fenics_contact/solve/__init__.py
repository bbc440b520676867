"""From a problem to nodal values: Section 4.1 of the paper.

From the bottom: ``systems``, then ``condensed`` and ``iterative``, ``newton``, the ways to Coulomb
friction in ``coulomb``, and ``load_steps``. ``solver_choice`` says which system is solved.
"""
