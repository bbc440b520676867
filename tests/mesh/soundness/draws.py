"""Damaged files at random: a scene on a block, its file in one of three formats, and a damage.

The damage is of the block (``damages``) or of the lines of its file, as slips of the pen, copying
and other programs make them.
"""

import random
import re
from dataclasses import dataclass

from tests.mesh.readers.blocks import Block, bdf, inp
from tests.mesh.soundness.damages import HARMLESS, REFUSED, REFUSED_OF_ORDER_2, msh

KINDS = {
    "triangle": {1: ("CPE3", "CTRIA3", "CROD"), 2: ("CPE6",)},
    "quadrilateral": {1: ("CPE4", "CQUAD4", "CBAR"), 2: ("CPE8",)},
    "tetrahedron": {1: ("C3D4", "CTETRA", "CTRIA3"), 2: ("C3D10",)},
    "hexahedron": {1: ("C3D8", "CHEXA", "CQUAD4"), 2: ("C3D20",)},
}
SIDES = {
    "inp": ("bottom", "n_top", "n_left"),
    "bdf": ("21", "22", "23"),
    "msh": ("bottom", "top", "left"),
}
SCENE = """kinematics = "{kinematics}"
mesh = {{ file = "{file}" }}
material = {{ youngs_modulus = 1000, poissons_ratio = 0.3 }}
discretisation = {{ degree = {degree} }}
solver = {{ errors = "none" }}
support = [{{ on = "{left}", displacement = {{ x = 0, y = 0{z} }} }}]
load = [{{ on = "{top}", pressure = 2 }}]
contact = [{{ on = "{bottom}", friction_coefficient = 0.2, obstacle = {{ shape = "plane", indentation = 0.01 }} }}]
"""  # noqa: E501
#: What must become of a file: a refusal, the answer of the sound one, either of these, or any
#: answer, where the damage may have made another body that is as sound.
REFUSAL, SAME, EITHER, ANY = "refused", "same", "either", "any"


@dataclass(frozen=True)
class DamagedFile:
    """A file at random.

    Attributes:
        text: Of the file.
        name: Of the file.
        scene: Text of the scene that solves it.
        damage: What was done.
        must: What must become of it.
        key: The same for files of the same body and the same scene before the damage.
    """

    text: str
    name: str
    scene: str
    damage: str
    must: str
    key: tuple[str, int]


def draw(seed, number):
    """A file by its number.

    Args:
        seed: Of all.
        number: Of this one.
    """
    chance = random.Random(f"{seed} {number}")
    suffix = chance.choice(list(SIDES))
    cell = chance.choice(list(KINDS))
    order = chance.choice((1, 2)) if suffix == "inp" else 1
    block = new_block(cell, order)
    kind = chance.random()
    if kind < 0.5:
        known = {**REFUSED, **(REFUSED_OF_ORDER_2 if order == 2 else {})}
        damage = chance.choice(list(known))
        damage(block, chance)
        text, must = as_text(block, suffix, order), EITHER
    elif kind < 0.6:
        damage = chance.choice(HARMLESS)
        damage(block, chance)
        text, must = as_text(block, suffix, order), SAME
    else:
        damage, must = chance.choice(of_lines(suffix, block.dimension))
        text = damage(as_text(block, suffix, order), chance)
    name = f"b.{suffix}"
    return DamagedFile(
        text, name, scene_of(block, name, order), damage.__name__, must, (cell, order)
    )


def sound(key):
    """The file of a body and its scene without any damage."""
    cell, order = key
    block = new_block(cell, order)
    return DamagedFile(
        *(as_text(block, "inp", order), "b.inp", scene_of(block, "b.inp", order), "none", SAME, key)
    )


def new_block(cell, order):
    return Block(cell, order, cells={2: (5, 3), 3: (4, 2, 2)}[2 if cell in KINDS_2D else 3])


KINDS_2D = ("triangle", "quadrilateral")


def as_text(block, suffix, order):
    kinds = KINDS[block.cell][order]
    if suffix == "msh":
        return msh(block)
    return inp(block, kinds[0]) if suffix == "inp" else bdf(block, *kinds[1:])


def scene_of(block, name, order):
    bottom, top, left = SIDES[name.rpartition(".")[2]]
    flat = block.dimension == 2
    return SCENE.format(
        kinematics="plane strain" if flat else "3D",
        file=name,
        degree=order,
        bottom=bottom,
        top=top,
        left=left,
        z="" if flat else ", z = 0",
    )


def of_lines(suffix, dimension):
    """Damages of text, with what must become of the file."""
    found = [
        (truncated, EITHER),
        (a_line_lost, ANY),
        (a_line_twice, EITHER),
        (two_lines_swapped, EITHER),
        (a_digit_changed, ANY),
        (windows_line_ends, SAME),
        (blank_lines, SAME if suffix == "inp" else EITHER),
        (lower_case, SAME if suffix == "inp" else ANY),
        (decimal_commas, REFUSAL),
    ]
    if suffix == "inp":
        found += [
            (a_set_defined_again, SAME),
            (a_surface_defined_again, SAME),
            (comments, SAME),
            (shells_elsewhere, SAME if dimension == 3 else ANY),
            (a_node_elsewhere_too, REFUSAL),
            (element_numbers_twice, REFUSAL),
        ]
        found += [(made_for_revolution, REFUSAL)] * (dimension == 2)
    return found


def changed_lines(text, change):
    lines = text.splitlines(keepends=True)
    change(lines)
    return "".join(lines)


def truncated(text, chance):
    return text[: chance.randrange(len(text))]


def a_line_lost(text, chance):
    return changed_lines(text, lambda lines: lines.pop(chance.randrange(len(lines))))


def a_line_twice(text, chance):
    def change(lines):
        at = chance.randrange(len(lines))
        lines.insert(at, lines[at])

    return changed_lines(text, change)


def two_lines_swapped(text, chance):
    def change(lines):
        at = chance.randrange(len(lines) - 1)
        lines[at : at + 2] = lines[at : at + 2][::-1]

    return changed_lines(text, change)


def a_digit_changed(text, chance):
    place = chance.choice([found.start() for found in re.finditer(r"\d", text)])
    return text[:place] + chance.choice("0123456789") + text[place + 1 :]


def windows_line_ends(text, chance):
    return text.replace("\n", "\r\n")


def blank_lines(text, chance):
    def change(lines):
        for _ in range(5):
            lines.insert(chance.randrange(len(lines)), "\n")

    return changed_lines(text, change)


def comments(text, chance):
    return text.replace("\n*", "\n** a comment, with 1, 2, 3\n*")


def lower_case(text, chance):
    """Of keywords and their options; names of sets stay."""
    return re.sub(
        r"(?m)^\*[A-Z]+|\b(?:NSET|ELSET|TYPE|NAME|INTERNAL)\b(?==|$)",
        lambda found: found[0].lower(),
        text,
    )


def decimal_commas(text, chance):
    return re.sub(r"(?<=\d)\.(?=\d)", ",", text)


def a_set_defined_again(text, chance):
    return text + text[text.index("*NSET, NSET=n_top") : text.index("*NSET, NSET=n_left")]


def a_surface_defined_again(text, chance):
    block = re.search(r"\*SURFACE, NAME=bottom[^*]*", text)[0]
    return text.replace(block, 2 * block)


def shells_elsewhere(text, chance):
    nodes = "".join(f"{9000 + n}, {n % 2}, {n // 2}, 7\n" for n in range(4))
    return f"{text}*NODE\n{nodes}*ELEMENT, TYPE=S4, ELSET=TOOL\n9000, 9000, 9001, 9003, 9002\n"


def a_node_elsewhere_too(text, chance):
    return f"{text}*NODE\n12, 0.123, 0.2, 0\n"


def element_numbers_twice(text, chance):
    return text.replace("\n103, ", "\n102, ", 1)


def made_for_revolution(text, chance):
    return text.replace("TYPE=CPE", "TYPE=CAX")
