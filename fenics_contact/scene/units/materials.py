"""Materials that a scene may name, with their elasticities and densities in SI and their sources.

Values are those of standards and of a textbook, at room temperature; a part's own may differ by
some per cent, of cast irons and plastics by more.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class NamedMaterial:
    """A material of the table.

    Attributes:
        name: As a scene has it.
        youngs_modulus: In GPa.
        poissons_ratio: A pure number.
        density: In kg/m³.
        thermal_expansion: In 10⁻⁶/K, the mean from room temperature to 100 °C.
        source: Of the values.
    """

    name: str
    youngs_modulus: float
    poissons_ratio: float
    density: float
    thermal_expansion: float
    source: str


_STEEL = "EN 1993-1-1:2005, 3.2.6; density EN 1991-1-1:2002, table A.4"
_STAINLESS = "EN 10088-1:2014; Poisson's ratio EN 1993-1-4:2006, 2.1.3"
_ALUMINIUM = "EN 1999-1-1:2007, 3.2.5"
_CALLISTER = "W. D. Callister, Materials Science and Engineering, 7th ed., 2007, appendix B"

_ROWS = (
    NamedMaterial("steel S235", 210.0, 0.3, 7850.0, 12.0, _STEEL),
    NamedMaterial("steel S275", 210.0, 0.3, 7850.0, 12.0, _STEEL),
    NamedMaterial("steel S355", 210.0, 0.3, 7850.0, 12.0, _STEEL),
    NamedMaterial("steel S460", 210.0, 0.3, 7850.0, 12.0, _STEEL),
    NamedMaterial("steel 4340", 207.0, 0.3, 7850.0, 12.3, _CALLISTER),
    NamedMaterial("stainless steel 1.4301", 200.0, 0.3, 7900.0, 16.0, _STAINLESS),
    NamedMaterial("stainless steel 1.4404", 200.0, 0.3, 8000.0, 16.0, _STAINLESS),
    NamedMaterial(
        "cast iron EN-GJL-250", 110.0, 0.26, 7200.0, 11.7, "EN 1561:2011 (E from 103 to 118 GPa)"
    ),
    NamedMaterial("cast iron EN-GJS-400-15", 169.0, 0.275, 7100.0, 12.5, "EN 1563:2011"),
    NamedMaterial("aluminium 5083", 70.0, 0.3, 2700.0, 23.0, _ALUMINIUM),
    NamedMaterial("aluminium 6082", 70.0, 0.3, 2700.0, 23.0, _ALUMINIUM),
    NamedMaterial("aluminium 2024", 72.4, 0.33, 2770.0, 22.9, _CALLISTER),
    NamedMaterial("aluminium 6061", 69.0, 0.33, 2700.0, 23.6, _CALLISTER),
    NamedMaterial("aluminium 7075", 71.0, 0.33, 2800.0, 23.4, _CALLISTER),
    NamedMaterial("magnesium AZ31B", 45.0, 0.35, 1770.0, 26.0, _CALLISTER),
    NamedMaterial("titanium Ti-6Al-4V", 114.0, 0.34, 4430.0, 8.6, _CALLISTER),
    NamedMaterial("nickel alloy 625", 207.0, 0.31, 8440.0, 12.8, _CALLISTER),
    NamedMaterial("copper C11000", 115.0, 0.33, 8890.0, 17.0, _CALLISTER),
    NamedMaterial("brass C26000", 110.0, 0.35, 8530.0, 19.9, _CALLISTER),
    NamedMaterial("brass C36000", 97.0, 0.34, 8500.0, 20.5, _CALLISTER),
    NamedMaterial(
        "concrete C30/37",
        33.0,
        0.2,
        2400.0,
        10.0,
        "EN 1992-1-1:2004, 3.1.3; density EN 1991-1-1:2002, table A.1",
    ),
    NamedMaterial("glass", 70.0, 0.2, 2500.0, 9.0, "EN 572-1:2012, soda-lime silicate glass"),
    NamedMaterial("alumina", 380.0, 0.22, 3980.0, 7.4, f"{_CALLISTER} (99.9 % pure)"),
    NamedMaterial("silicon nitride", 304.0, 0.3, 3300.0, 2.7, f"{_CALLISTER} (hot pressed)"),
    NamedMaterial("polycarbonate", 2.38, 0.36, 1200.0, 122.0, _CALLISTER),
)
MATERIALS = {one.name: one for one in _ROWS}


def names() -> tuple[str, ...]:
    """Return the names of all materials of the table."""
    return tuple(MATERIALS)


_HEAD = ("name", "E (GPa)", "ν", "ρ (kg/m³)", "α (10⁻⁶/K)", "source")


def rows() -> list[tuple[str, ...]]:
    """Return the table in words: a head, and a row for each material."""
    found: list[tuple[str, ...]] = [_HEAD]
    for one in MATERIALS.values():
        values = (
            one.youngs_modulus,
            one.poissons_ratio,
            one.density,
            one.thermal_expansion,
        )
        found.append((one.name, *(f"{value:g}" for value in values), one.source))
    return found


def as_text() -> str:
    """Return the table with a line for each material, as the command ``materials`` prints it."""
    table = rows()
    widths = [max(len(row[column]) for row in table) for column in range(len(_HEAD) - 1)]
    lines = []
    for name, *values, source in table:
        said = [f"{value:>{width}}" for value, width in zip(values, widths[1:], strict=True)]
        lines.append("  ".join([f"{name:<{widths[0]}}", *said, source]))
    return "\n".join(lines)


def as_page() -> str:
    """Return the page of the documentation, in Markdown."""
    head, *body = rows()
    lines = [
        "# Materials by name",
        "",
        "Generated from the code by `python docs/make_materials.py`; do not edit.",
        "",
        'A scene with `[units]` may name its material, such as `material.name = "steel S355"`',
        "([how to](howto/materials.md)); `fenics-contact materials` prints this table. Values are",
        "those at room temperature.",
        "",
        f"| {' | '.join(head)} |",
        f"|---|{'---:|' * (len(head) - 2)}---|",
        *(f"| `{row[0]}` | {' | '.join(row[1:])} |" for row in body),
    ]
    return "\n".join(lines) + "\n"
