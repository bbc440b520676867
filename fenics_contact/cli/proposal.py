"""The scene that ``look`` proposes: contacts that were found, and examples to be replaced.

It is made of plain names only. What a file calls its bodies and groups stands in quoted strings of
TOML, and in comments in one line.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import tomlkit

from fenics_contact.common.arrays import Array
from fenics_contact.common.wording import one_line, plain_name, unique_names
from fenics_contact.mesh.facing_surfaces import Pair, bolts, loose_pieces
from fenics_contact.mesh.survey import FoundSurface, Survey

_REPLACE = "TO BE REPLACED"
_FLAT = ("plane", "straight line")
# A radius counts as small that is smaller than this times the smallest one of a contact.
_SMALL = 0.5


@dataclass(frozen=True)
class Contact:
    """A contact that is proposed.

    Attributes:
        name: Its own.
        pair: What it is between.
        on: The group on the first body.
        against: The group on the second.
    """

    name: str
    pair: Pair
    on: str
    against: str


class Proposal:
    """A scene for what was found in a file.

    Attributes:
        contacts: Between the pairs.

    Args:
        found: Bodies and surfaces.
        pairs: That face each other.
        file: The file, as the scene is to name it.
        curvature: Of its mesh, where it is a CAD file.
        is_geometry: Whether it is to be meshed.
        kinematics: What the file's elements are made for; empty if it does not say.
        order: Of the cells, where the file is a mesh.
    """

    def __init__(
        self,
        found: Survey,
        pairs: Sequence[Pair],
        file: str,
        curvature: int | None,
        is_geometry: bool,
        kinematics: str = "",
        order: int = 1,
    ) -> None:
        self._found, self._file = found, file
        self._curvature, self._is_geometry = curvature, is_geometry
        self._kinematics, self._order = kinematics, order
        self._groups: dict[str, tuple[int, ...]] = {}
        self._is_all_held = True
        self._bonded: set[int] = set()
        self._taken = {name for surface in found.surfaces for name in surface.names}
        self._taken |= {body.name for body in found.bodies} | {"body"}
        bodies = [
            plain_name(body.label) or f"body_{number}"
            for number, body in enumerate(found.bodies, start=1)
        ]
        between = [tuple(bodies[n] for n in pair.bodies) for pair in pairs]
        names = unique_names(["-".join(two) for two in between], "contact", ())
        self.contacts = [
            Contact(
                name,
                pair,
                self._group(f"{one}_at_{other}", pair.first),
                self._group(f"{other}_at_{one}", pair.second),
            )
            for name, pair, (one, other) in zip(names, pairs, between, strict=True)
        ]
        self._bolts = bolts(found, pairs) if curvature is not None and found.are_named else []
        places = self._places_to_hold()
        self._held = [self._group("fixed", (n,)) for n in places]
        held = {found.surfaces[n].piece for n in places}
        self._loose = [body.label for body in found.bodies if held.isdisjoint(body.pieces)]

    def text(self) -> str:
        """The scene file."""
        return "\n".join(
            [
                *self._head(),
                *self._mesh(),
                *self._materials(),
                *self._supports(),
                *self._preloads(),
                *self._contacts(),
                *self._loads(),
                *self._steps(),
                "",
            ]
        )

    def _group(self, name: str, places: Sequence[int]) -> str:
        """The name of a group of surfaces: of the file, of this scene, or one that is made."""
        surfaces = [self._found.surfaces[place] for place in places]
        if len(surfaces) == 1 and surfaces[0].name:
            return surfaces[0].name
        numbers = tuple(surface.number for surface in surfaces if surface.number is not None)
        for known, parts in self._groups.items():
            if parts == numbers:
                return known
        (found,) = unique_names([name], "surface", self._taken)
        self._taken.add(found)
        self._groups[found] = numbers
        return found

    def _places_to_hold(self) -> list[int]:
        """A surface of each set of pieces that contacts join, and of pieces that could come off.

        Of the largest body of each, if that has one.
        """
        found = self._found
        touched = {place for c in self.contacts for place in (*c.pair.first, *c.pair.second)}
        of_piece = {piece: piece for body in found.bodies for piece in body.pieces}
        for contact in self.contacts:
            one, other = (
                of_piece[found.surfaces[side[0]].piece]
                for side in (contact.pair.first, contact.pair.second)
            )
            of_piece = {p: one if joined == other else joined for p, joined in of_piece.items()}

        def fitness(place: int) -> tuple[bool, float, float, float]:
            surface = found.surfaces[place]
            largest = max(found.bodies[n].measure for n in surface.bodies)
            opposite = -float(surface.normals[0] @ self._contact_normal(surface.piece))
            return surface.shape.kind in _FLAT, largest, round(opposite, 3), surface.measure

        def best(pieces: Collection[int]) -> list[int]:
            places = [
                n
                for n, surface in enumerate(found.surfaces)
                if surface.can_touch and surface.piece in pieces and n not in touched
            ]
            return [max(places, key=fitness)] if places else []

        chosen = []
        for joined in sorted(set(of_piece.values())):
            places = best([p for p, other in of_piece.items() if other == joined])
            self._is_all_held &= bool(places)
            chosen += places
        pairs = [contact.pair for contact in self.contacts]
        held = {found.surfaces[n].piece for n in chosen}
        while loose := loose_pieces(found, pairs, held):
            piece = min(loose, key=self._measure)
            held.add(piece)
            places = best([piece])
            chosen += places
            if not places:
                self._bonded.add(piece)
        return chosen

    def _contact_normal(self, piece: int) -> Array:
        """Mean outward normal of a piece's surfaces in contacts, at most of length 1."""
        places = {n for c in self.contacts for n in (*c.pair.first, *c.pair.second)}
        normals = [
            surface.normals.mean(axis=0)
            for surface in (self._found.surfaces[n] for n in places)
            if surface.piece == piece
        ]
        return np.asarray(np.mean(normals, axis=0)) if normals else np.zeros(3)

    def _measure(self, piece: int) -> float:
        return sum(body.measure for body in self._found.bodies if piece in body.pieces)

    def _head(self) -> Iterator[str]:
        yield "# A scene to complete: what is marked with REPLACE is an example."
        yield "# Look at look.html beside it for the numbers of bodies and surfaces."
        stem = self._file.rpartition("/")[2].rpartition(".")[0]
        yield f"title = {_quoted(plain_name(stem) or 'Scene')}"
        plane = self._found.dimension == 2
        kind = self._kinematics or ("plane strain" if plane else "3D")
        others = '  # or "plane stress", "axisymmetric"'
        if self._kinematics:
            others = "  # as the types of the file's elements say"
        yield f'kinematics = "{kind}"{others if plane else ""}'

    def _mesh(self) -> Iterator[str]:
        yield from ("", "[mesh]", f"file = {_quoted(self._file)}")
        is_round = self._is_geometry and self._is_round()
        if self._curvature is not None:
            yield f"curvature = {self._curvature}  # cells around a full circle"
            least = self._size_of_contacts()
            if least:
                yield f"least_size = {_figures(least)}  # at radii smaller than those of contacts"
        if is_round:
            yield "order = 2  # curved cells: round surfaces in contact keep their shape"
        if self._is_geometry:
            size = _figures(self._found.size / (5 if is_round else 10))
            yield f"# size = {size}  # largest cell"
            names = [body.name for body in self._found.bodies if body.name]
            if len(names) > 1:
                sizes = ", ".join(f"{_quoted(name)} = {size}" for name in names)
                yield f"# sizes = {{ {one_line(sizes)} }}  # of single bodies"
        if self._groups:
            yield from ("", "[mesh.groups]  # surfaces by their numbers")
        for name, numbers in self._groups.items():
            yield f"{name} = {list(numbers)}"
        yield from ("", "[discretisation]")
        if is_round or self._order > 1:  # degree 1 cannot turn curved cells without straining them
            yield "degree = 2  # as curved cells want it; degree = 1 only with order = 1"
        else:
            yield "degree = 1  # 2 for results that count"
        if not self._is_all_held:
            yield from ("", "[solver]")
            yield f"stabilisation = true  # {_REPLACE}: some bodies have no surface to hold"

    def _size_of_contacts(self) -> float | None:
        """The size of cells at the smallest radius of a contact, where some are much smaller."""
        touched = {n for c in self.contacts for n in (*c.pair.first, *c.pair.second)}
        surfaces = self._found.surfaces
        radii = {n: s.shape.radius for n, s in enumerate(surfaces) if s.shape.radius}
        least = min((radius for n, radius in radii.items() if n in touched), default=0.0)
        if self._curvature is None or min(radii.values(), default=least) >= _SMALL * least:
            return None
        return min(2 * math.pi * least / self._curvature, self._found.size / 10)

    def _is_round(self) -> bool:
        """Whether a surface of a contact is not plane."""
        places = {n for c in self.contacts for n in (*c.pair.first, *c.pair.second)}
        return any(self._found.surfaces[n].shape.kind not in _FLAT for n in places)

    def _materials(self) -> Iterator[str]:
        steel = ("youngs_modulus = 210e3  # in N and mm: steel", "poissons_ratio = 0.3")
        bodies = self._found.bodies
        if not self._found.are_named or len(bodies) == 1:
            yield from ("", f"[material]  # {_REPLACE}", *steel)
            return
        for body in bodies:
            yield from ("", f"[[material]]  # {_REPLACE}", f"on = {_quoted(body.name)}", *steel)

    def _supports(self) -> Iterator[str]:
        axes = ", ".join(f"{axis} = 0" for axis in "xyz"[: self._found.dimension])
        for name in self._held:
            yield from ("", f"[[support]]  # {_REPLACE}: an example that holds all of a surface")
            yield from (f"on = {_quoted(name)}", f"displacement = {{ {axes} }}")
        if self._loose and self._held:
            names = one_line(", ".join(f"'{name}'" for name in self._loose))
            yield from ("", f"# Held by contacts alone: {names}; by a [[support]], if by more.")

    def _preloads(self) -> Iterator[str]:
        """Yield lines of preloads of bolts in CAD files, whose shanks can be cut out."""
        for bolt in self._bolts:
            axis = ", ".join(f"{_rounded(part):g}" for part in bolt.axis)
            first, last = (f"{_rounded(place):g}" for place in bolt.between)
            yield from ("", f"[[preload]]  # {_REPLACE}: a bolt, with 100 N/mm² in its shank")
            yield f"on = {_quoted(self._found.bodies[bolt.body].name)}"
            yield f"between = [{first}, {last}]  # along the axis: it is cut there before meshing"
            yield from (f"axis = [{axis}]", f"force = {_figures(100 * bolt.area)}")
            yield "locked_from = 1  # tightened in the first load step, then its length is kept"

    def _contacts(self) -> Iterator[str]:
        for contact in self.contacts:
            yield from ("", f"# {one_line(self._about(contact.pair))}", "[[contact]]")
            if contact.name != contact.on:
                yield f"name = {_quoted(contact.name)}"
            yield from (f"on = {_quoted(contact.on)}", f"against = {_quoted(contact.against)}")
            sides = (contact.pair.first, contact.pair.second)
            if {self._found.surfaces[side[0]].piece for side in sides} & self._bonded:
                yield f'contact = "bonded"  # {_REPLACE}: "unilateral", once a load presses on it'
            else:
                if self._may_be_thread(contact.pair):
                    yield '# if this is a thread, or is glued: contact = "bonded", without friction'
                yield from ('contact = "unilateral"', f"friction_coefficient = 0.2  # {_REPLACE}")
                if self._bolts:
                    yield 'law = "incremental"  # slip counts from the load step before'

    def _may_be_thread(self, pair: Pair) -> bool:
        """Whether a shaft is in a hole without play."""
        kind = self._found.surfaces[pair.first[0]].shape.kind
        return kind == "cylinder" and pair.is_exact and pair.gap <= 0

    def _about(self, pair: Pair) -> str:
        surfaces = [
            ", ".join(_called(self._found.surfaces[n]) for n in side)
            for side in (pair.first, pair.second)
        ]
        bodies = [self._found.bodies[n].label for n in pair.bodies]
        of_both = " and ".join(
            f"{side} of '{body}'" for side, body in zip(surfaces, bodies, strict=True)
        )
        return f"{of_both}: {gap_words(pair)}"

    def _loads(self) -> Iterator[str]:
        """Yield lines of a load, as an example that is left out."""
        free = [s for s in self._found.surfaces if s.number is not None and not s.is_inside]
        name = free[-1].number if free else "NAME"
        force, moment = ("[0, -100]", "1000") if self._found.dimension == 2 else _IN_SPACE
        yield from ("", "# [[load]]  # what acts on a surface")
        yield f'# on = "{name}"  # a name, or a number in quotes'
        yield f"# force = {force}  # or pressure = 1, or traction = {force}"
        yield f"# moment = {moment}  # with the force, or alone"
        if self._bolts:
            yield "# path = { time = [1, 2], factor = [0, 1] }  # once the bolts are tight"

    def _steps(self) -> Iterator[str]:
        """Yield lines of load steps, where a bolt is tightened in the first one."""
        if self._bolts:
            yield from ("", "[steps]", "times = [1, 2]  # the bolts, then the loads")


# A force and a moment as examples, in space.
_IN_SPACE = "[0, 0, -100]", "[0, 0, 1000]"


def gap_words(pair: Pair) -> str:
    """How far apart the surfaces of a pair are."""
    area = f"over about {float(f'{pair.area:.3g}'):.12g}"
    if pair.gap == 0 or abs(pair.gap) < 1e-9 * math.sqrt(pair.area):
        return f"touch {area}"
    about = "" if pair.is_exact else "about "
    if pair.gap < 0:
        return f"overlap by {about}{-pair.gap:.3g} {area} (a press fit, if it is meant)"
    return f"are {about}{pair.gap:.3g} apart {area}"


def _called(surface: FoundSurface) -> str:
    return f"surface {surface.number}" if surface.number is not None else f"'{surface.name}'"


def _quoted(text: str) -> str:
    """A string of TOML, whatever is in the text; what cannot be seen in it is written out."""
    quoted = tomlkit.string(text).as_string()
    return "".join(c if c.isprintable() else f"\\U{ord(c):08X}" for c in quoted)


def _rounded(value: float) -> float:
    return float(f"{value:.4g}") + 0.0


def _figures(value: float) -> str:
    return f"{value:.2g}" if value < 100 else f"{value:.0f}"
