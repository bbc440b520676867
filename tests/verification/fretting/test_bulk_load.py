"""The case of fretting under bulk load can fail: judged by another pull it does."""

from fenics_contact import Run
from fenics_contact.verification.published.fretting import Pulled, bulk_scene, compared


def test_another_pull_is_noticed() -> None:
    sheared = Pulled(0.6, 0.5)
    prepared = Run(bulk_scene(sheared, size=0.05, cells_outside=20))
    result = prepared.solve()
    right = list(compared(prepared, result, sheared))
    assert [found.passed for found in right] == [True, True, True]
    wrong = list(compared(prepared, result, Pulled(0.6, 0.4)))
    assert [found.passed for found in wrong] == [False, True, False]
