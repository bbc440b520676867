"""A state file that is kept in the repository is gone on from."""

import dataclasses

import pytest
from mpi4py import MPI

from fenics_contact import (
    Accuracy,
    Contact,
    CycleJump,
    Cycles,
    Discretisation,
    HalfSpace,
    Load,
    Material,
    MicroSlipFriction,
    Motion,
    MotionModes,
    NormalCompliance,
    Obstacle,
    OwnFrictionLaw,
    Path,
    Preload,
    PressureFormula,
    Profile,
    Rayleigh,
    Run,
    Steps,
    Support,
    Wear,
    load_scene,
)
from fenics_contact.simulation import fingerprint
from fenics_contact.simulation.fingerprint import keys_in_format_1
from fenics_contact.simulation.state_file import StateFile
from tests.messages import refused
from tests.scenes import ROOT, box_body
from tests.solve.load_steps.histories import require_same

COMM = MPI.COMM_WORLD
# Written by commit 339c70e7 after two load steps: two blocks with wear and slip dependent friction.
FOLDER = ROOT / "tests" / "data" / "state_of_today"
LONGER = Steps(times=(1, 1.5, 2))

RISING = Path((0, 1, 2), (0, 1, 0), cycles=2)
PLANE = Obstacle("plane", position=(0, 0))
FORMULA = PressureFormula("formula", "c * d", {"c": 2e4})
# Tables of scenes, with what commit 339c70e7 made of them.
TABLES = {
    "c0d781acc0b115ba": Material(1000, 0.3),
    "3f49170ca7b0160c": Material(1000, 0.3, on="body", density=2.0),
    "83a1a1266635f09f": Discretisation(),
    "13db9e9da24c4b83": Support("y0", {"x": 0, "y": Profile("x", (0, 1), (1, 2))}),
    "e7254912edaa7a5a": Support("y0", {"x": 0}, RISING, name="left"),
    "92acb50b3ec6b95e": Load("y1", pressure=3),
    "31190c84613cea23": Load("y1", traction=(1, 2), path=RISING),
    "51820909741cb868": Preload("bolt", (1, 0), 3),
    "188dba186e0245ff": Preload("b", (1, 0), 3, RISING, locked_from=1, name="c", between=(0, 1)),
    "086442c28755b69b": Contact("y1", friction_coefficient=0.3),
    "21c19e2ce6b591aa": Contact("y1", pressure=10, pressure_path=RISING, name="pad"),
    "4e327b6ec95afc3d": Contact("y1", obstacle=PLANE, interference=1e-3, interference_path=RISING),
    "49aed5b538753375": Contact("y1", against="y2", slave="on", wear=Wear(1e-3, share=0.5)),
    "5d90d2ada1540188": Contact("y1", foundation_stiffness=3, wear=Wear(1e-3, threshold=2)),
    "eacac5bcae7fdfab": Contact("y1", friction_law=MicroSlipFriction("micro-slip", 1e-3)),
    "ca3dd5c7509a76cb": Contact("y1", friction_law=OwnFrictionLaw("laws:Own"), law="incremental"),
    "034fdc9a01e549a8": Contact("y1", normal_law=FORMULA, regularisation_parameter=1e-3),
    "948c39acb3c560f3": Contact("y1", normal_law=NormalCompliance("normal compliance", 2, 2)),
    "1fe0f6792c9c6f7e": Obstacle("sphere", radius=8, force=4, displacement=(1, 0, 0), path=RISING),
    "101db3708ef9cc84": HalfSpace(("outer",)),
    "36768b2e2f1156c3": Accuracy(1e-2),
    "06d84d597e918385": Cycles(end=5, begin=1, number=3),
    "3c541f5a5802340d": Cycles(end=5, begin=1, until="end", jumps=CycleJump(error=1e-3)),
    "4cad3f72ffaca230": Motion(step=0.01, end=2),
    "e22be3434acb3054": Motion("automatic", 2, {"body": (1, 0)}, "static", Rayleigh(1), ("x1",)),
    "9b10f336f660a603": Motion(step=0.01, end=2, modes=MotionModes(3)),
}


def silent(number, step):
    """Nothing to be said of a step."""


def test_it_is_gone_on_from():
    scene = dataclasses.replace(load_scene(FOLDER / "scene.toml"), steps=LONGER)
    whole = Run(scene, COMM).solve(announce=silent)
    run = Run(scene, COMM)
    saved = StateFile(FOLDER, run.problem).load()
    assert saved is not None and len(saved.steps) == 2
    found = run.solve(saved=saved, announce=silent)
    assert len(found.steps) == 3 and whole.quantities["worn_volume"] > 0
    # The first step's regularisation follows from pressures that are found under glue today: its
    # work of creep, 3e-5 of all, differs by .5 % from that of the file.
    require_same(found, whole, 1e-6)


def test_tables_have_the_fingerprints_of_then():
    probe = fingerprint._Probe(box_body((1, 1)), keys_in_format_1)
    found = [fingerprint._digest(probe.plain(table)) for table in TABLES.values()]
    assert found == list(TABLES)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"friction_law": None}, "resume_with_another_contact"),
        ({"interference": 0.0}, "resume_with_another_contact"),
        ({"wear": Wear(2e-3, share=0.5)}, "resume_with_another_contact"),
    ],
)
def test_it_is_refused_for_another_scene(change, words):
    scene = load_scene(FOLDER / "scene.toml")
    first, second = scene.contact
    changed = dataclasses.replace(
        scene, contact=(first, dataclasses.replace(second, **change)), steps=LONGER
    )
    with refused(words):
        StateFile(FOLDER, Run(changed, COMM).problem).load()
