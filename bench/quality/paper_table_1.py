# SPDX-License-Identifier: GPL-3.0-or-later
"""Table 1 of Bernardini, Bajaj, Chen, Schikore 1997, and which of our files stands for which of its objects.

Not one of the paper's point sets is published, so none of these files is the same data.
"""
from dataclasses import dataclass

MACHINE = "SGI Indigo2, MIPS R4400 of 250 MHz"


@dataclass(frozen=True)
class Printed:
    """A line of the paper's table."""

    points: int
    minutes: float
    tetrahedra: int  #: of the initial alpha-solid
    removed: int  #: of these, by sculpting
    triangles: int


PAPER = {
    "Femur": Printed(9807, 1.5, 36182, 3704, 19610),
    "Tibia": Printed(9200, 1.4, 33232, 2172, 18396),
    "Fibula": Printed(8146, 1.1, 30876, 2896, 16288),
    "Patella": Printed(2050, 0.3, 7536, 683, 4096),
    "CSG Solid": Printed(13040, 2.5, 42507, 2473, 26088),
    "Club": Printed(16864, 4.1, 58657, 754, 33142),
    "Bunny": Printed(33123, 19.6, 127607, 3761, 66224),
    "Mannequin": Printed(10392, 2.1, 35383, 2077, 19802),
}


@dataclass(frozen=True)
class StandIn:
    """A file of ours; its points count, whatever else it holds."""

    paper: str  #: the paper's object, "" for one that it does not have
    file: str
    fetched: bool  #: below build/data, by `make data`; else among the files that may be there or not
    what: str  #: what it is, and so why it is not the paper's


STAND_INS = [
    StandIn("Femur", "meshes/femur.off", True,
            "another femur, fewer points, the corners of a mesh with two handles; the paper's came from CT slices"),
    StandIn("Femur", "7-seed-like/femur_gfxmorph.stl", False,
            "a third femur, the corners of a closed mesh"),
    StandIn("CSG Solid", "meshes/anchor_dense.off", True,
            "another machine part with holes, the corners of its mesh; the paper's solid was sampled at random"),
    StandIn("CSG Solid", "meshes/fandisk_large.off", True,
            "another machine part, without holes, the corners of its mesh"),
    StandIn("Club", "8-derived/golf_club.ply", False, "a golf club, fewer points, the corners of an open mesh"),
    StandIn("Bunny", "meshes/bunny00.off", True, "the bunny, sampled otherwise, the corners of a closed mesh"),
    StandIn("Bunny", "1-bunny/bun_zipper.ply", False,
            "the bunny as Stanford merged it, open underneath, with 1,113 points that are in no triangle of theirs"),
    StandIn("Mannequin", "meshes/mannequin-devil.off", True,
            "a mannequin's head with horns, more points, the corners of a mesh that is open at the neck"),
    StandIn("", "points_3/kitten.xyz", True, "points without a mesh, of a kitten with one handle"),
]

#: Objects of the paper that no file of ours stands for.
WITHOUT = [name for name in PAPER if name not in {one.paper for one in STAND_INS}]
