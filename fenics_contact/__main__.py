"""``python -m fenics_contact``: the same as the command ``fenics-contact``."""

import sys

from fenics_contact.cli.program import main

sys.exit(main())
