"""What the terminal shows: the model before, the numbers and checks after."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from fenics_contact.result import Result
from fenics_contact.scene import Scene

_SHOWN = (
    "normal_force",
    "friction_force",
    "reaction",
    "max_contact_pressure",
    "contact_area",
    "stick_area",
    "slip_area",
    "max_slip",
    "strain_energy",
    "friction_work",
)


def print_model(scene: Scene, model: Mapping[str, Any], contacts: list[dict[str, Any]]) -> None:
    """Say what would be modelled: ``fenics-contact check``."""
    console = Console()
    table = _table("", "")
    for key, value in model.items():
        if key != "terms":
            table.add_row(key.replace("_", " "), _written(value))
    console.print(f"\n[bold]{escape(scene.title or 'Scene')}[/bold]")
    console.print(table)
    console.print("Energy terms modelled:")
    for term in model["terms"]:
        console.print(f"  {term}", markup=False)
    for contact in contacts:
        console.print(
            f"Contact {contact['name']}: {contact['contact']}, friction law {contact['law']}, "
            f"regularisation parameter {contact['parameters']['regularisation_parameter']:.3g}",
            markup=False,
            highlight=False,
        )
    console.print("The scene can be run: supports and friction can hold the loads.")


def print_result(result: Result, folder: Path) -> None:
    """Say what came out and whether to trust it."""
    console = Console()
    console.print(f"\n[bold]{escape(result.title or 'Result')}[/bold]", highlight=False)
    if result.converged:
        quantities = _table("quantity", "value")
        for key in _SHOWN:
            quantities.add_row(key.replace("_", " "), _written(result.quantities[key]))
        console.print(quantities)
        checks = _table("check", "value", "limit", "")
        for name, check in result.checks.items():
            verdict = "passed" if check.passed else "[bold red]FAILED[/bold red]"
            checks.add_row(
                name.replace("_", " "), f"{check.value:.2e}", f"{check.limit:.2e}", verdict
            )
        console.print(checks)
    console.print(result.verdict, markup=False, highlight=False)
    console.print(
        f"{result.timings['total']:.2f} s, {result.steps[0]['newton_iterations']} Newton steps. "
        f"Files in {folder}/",
        markup=False,
        highlight=False,
    )


def _table(*headers: str) -> Table:
    table = Table(box=box.SIMPLE, show_header=any(headers), pad_edge=False)
    for header in headers:
        table.add_column(header)
    return table


def _written(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list | tuple):
        return ", ".join(_written(entry) for entry in value)
    return str(value)
