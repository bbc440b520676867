"""Analyses that a scene asks of an answer, or of its load steps, by a table each: a folder each.

A folder says by ``ANALYSIS`` in its ``__init__`` what it is (``analysis.py``), and has these parts,
of which each may be missing:

- ``table``: classes of the scene's tables, and ``require``, what must hold of the scene;
- ``record``: what stands of it in ``result.json``;
- ``words``: ``plan``, ``tables`` and ``notes``, for the terminal (``AnalysisWords``);
- ``page``: sections of the page, and pictures (``AnalysisPage``);
- ``task``: what is computed in a run, along its load steps and after its answer
  (``AnalysisTask``), or instead of taking these one after the other (``StepDriver``);
- ``files``: what it writes beside ``result.json``: ``tables``, of a result rows by name;
- ``losses``: ``cycles`` of ``result.json``, where it takes the load steps in its own way.

Parts are imported where a scene or a result asks for them. ``registry.py`` has the list.
"""
