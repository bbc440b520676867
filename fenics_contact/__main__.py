"""``python -m fenics_contact``: the same as the command ``fenics-contact``."""

from fenics_contact.cli.process import run_as_process

run_as_process()
