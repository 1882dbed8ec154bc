# SPDX-License-Identifier: GPL-3.0-or-later
"""Table 1 of Bernardini, Bajaj, Chen, Schikore 1997, and our files for similar objects.

The paper's point sets are not published, so none of these files is the same data.
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
    """One of our files; only its points are used."""

    paper: str  #: the paper's object; "" if it has none like this
    file: str
    fetched: bool  #: whether `make data` fetches it to build/data; otherwise it is optional
    what: str  #: a description, and the difference from the paper's object


STAND_INS = [
    StandIn("Femur", "meshes/femur.off", True,
            "another femur with fewer points, the vertices of a mesh with two handles; the paper's points came from CT "
            "slices"),
    StandIn("Femur", "7-seed-like/femur_gfxmorph.stl", False,
            "a third femur, the vertices of a closed mesh"),
    StandIn("CSG Solid", "meshes/anchor_dense.off", True,
            "another machine part with holes, the vertices of its mesh; the paper's solid was sampled at random"),
    StandIn("CSG Solid", "meshes/fandisk_large.off", True,
            "another machine part without holes, the vertices of its mesh"),
    StandIn("Club", "8-derived/golf_club.ply", False, "a golf club with fewer points, the vertices of an open mesh"),
    StandIn("Bunny", "meshes/bunny00.off", True, "the bunny with another sampling, the vertices of a closed mesh"),
    StandIn("Bunny", "1-bunny/bun_zipper.ply", False,
            "the bunny as merged by Stanford, open at the bottom, with 1,113 points that are in none of its triangles"),
    StandIn("Mannequin", "meshes/mannequin-devil.off", True,
            "a mannequin's head with horns and more points, the vertices of a mesh that is open at the neck"),
    StandIn("", "points_3/kitten.xyz", True, "a kitten with one handle, points without a mesh"),
]

#: Objects of the paper without a similar file.
WITHOUT = [name for name in PAPER if name not in {one.paper for one in STAND_INS}]
