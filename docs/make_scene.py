"""Write docs/scene.md from the code: ``python docs/make_scene.py``."""

from pathlib import Path

from fenics_contact.scene.reference import render

Path(__file__).with_name("scene.md").write_text(render(), encoding="utf-8")
