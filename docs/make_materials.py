"""Write docs/material_table.md from the code: ``python docs/make_materials.py``."""

from pathlib import Path

from fenics_contact.scene.units.materials import as_page

Path(__file__).with_name("material_table.md").write_text(as_page(), encoding="utf-8")
