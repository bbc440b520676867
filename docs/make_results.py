"""Write the tables of docs/results.md from the code: ``python docs/make_results.py``."""

from pathlib import Path

from fenics_contact.results.reference import with_tables

PAGE = Path(__file__).with_name("results.md")

PAGE.write_text(with_tables(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
