"""Pictures of wear over the load steps of a run."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fenics_contact.quantities.names import MAX_WEAR_DEPTH, WORN_VOLUME
from fenics_contact.report.drawing.figures import legend_beside, plain, save
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.units import labelled
from fenics_contact.report.histories.load_steps import followed, line, over_time
from fenics_contact.results.load_history import History
from fenics_contact.results.records.run import Outcome

_HEIGHT = 1.6
_PANELS = {
    WORN_VOLUME: ("worn volume, $V$", "volume"),
    MAX_WEAR_DEPTH: ("deepest wear, $h$", "length"),
}


def draw_worn_history(folder: Path, result: Outcome) -> list[Picture]:
    """Draw ``history_wear.png`` of a run with several load steps whose contacts wear.

    Args:
        folder: Where to.
        result: The content of its ``result.json``.
    """
    history = History.of(result)
    found = {
        contact.name: {name: history.of_contact(number, name) for name in _PANELS}
        for number, contact in enumerate(result.contacts)
    }
    worn = {name: values for name, values in found.items() if values[WORN_VOLUME] is not None}
    if len(history.steps) < 2 or not worn:
        return []
    figure, panels = over_time("Wear", [_HEIGHT] * len(_PANELS), history)
    for panel, (name, (words, unit)) in zip(panels, _PANELS.items(), strict=True):
        for number, (contact, values) in enumerate(worn.items()):
            curve = values[name]
            assert curve is not None
            line(panel, history.time, np.asarray(curve), plain(f"'{contact}'"), number)
        panel.set_ylabel(labelled(words, unit))
        panel.set_ylim(bottom=0)
        if len(worn) > 1:
            legend_beside(panel)
    figure.align_ylabels(panels)
    path = folder / "history_wear.png"
    save(figure, path)
    said = "Worn volume V and deepest wear h, of both surfaces together, over the pseudo-time t."
    return [Picture(path, "Wear", said, followed(figure, panels, history))]
