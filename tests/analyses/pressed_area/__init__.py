"""An analysis that is not the program's, all in one folder: which area carries a high pressure."""

from fenics_contact.analyses import registry
from fenics_contact.analyses.registry import Analysis
from fenics_contact.scene.reference import add_key, remove_key
from fenics_contact.scene.scene import Scene
from tests.analyses.pressed_area.table import PRESSED_AREA

KEY = "pressed_area"
ANALYSIS = Analysis(package=__name__, tables=(KEY,), records=(KEY,), files=r"pressed_area\.csv")


def register() -> None:
    """Make it known."""
    add_key(Scene, KEY, PRESSED_AREA)
    registry.register(__name__)


def unregister() -> None:
    """Make it unknown again."""
    registry.unregister(__name__)
    remove_key(Scene, KEY)
