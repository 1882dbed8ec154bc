# SPDX-License-Identifier: GPL-3.0-or-later
"""The numbers of Wang 2006 on thinning, triangulation and probing, and our files for similar scans.

wang_clouds.py computes the three clouds that the thesis gives by formulas. The scans are not published.
"""
from dataclasses import dataclass


@dataclass(frozen=True)
class Thinning:
    """A cloud given by a formula, thinned to a tolerance."""

    section: str
    cloud: str  #: its name in wang_clouds.py
    tolerance: float
    bin_size: float
    kept: int  #: 0: not printed


HEMISPHERE = Thinning("3.6.1", "hemisphere-8", 0.025, 1.2, 223)
CONE = Thinning("3.6.2", "cone", 0.02, 0.103, 0)

#: Printed numbers of points of the clouds given by formulas.
COUNTS = {"hemisphere-1": 188, "hemisphere-8-coarse": 292, "hemisphere-8": 1376, "cone": 1247, "hyperboloid": 7837}
STEP_DEGREES = 11.46  #: for the hemisphere of radius 1 at a tolerance of 0.005
CONE_CURVATURE = 15.25
HYPERBOLOID_CURVATURE = 1.42
#: The thesis prints no tolerance; this one is our choice.
HYPERBOLOID = Thinning("4.4.1", "hyperboloid", 0.02, 0.21, 707)
NOSE_TOLERANCE, NOSE_BIN = 0.6, 1.2
BLOCK_SIZE, BLOCK_RADII = (88, 95, 41), (21, 5)


@dataclass(frozen=True)
class Case:
    """A case of section 4.4."""

    what: str
    points: int
    bin_size: float  #: in mm
    kept: int
    facets: int  #: 0: not printed
    box: tuple  #: sides in mm; () if not printed
    euler: int  #: Euler characteristic of the described object: 1 for a disc, one less per hole
    holes: int

    @property
    def bin_share(self):
        """The voxel size as a share of the box's diagonal, for scans of other sizes."""
        return self.bin_size / sum(side * side for side in self.box) ** 0.5

    @property
    def boundary_edges(self):
        """By Euler's identity F = 2 V − 2 χ − b, if every kept point is in a facet; None without printed facets."""
        return 2 * self.kept - 2 * self.euler - self.facets if self.facets else None


@dataclass(frozen=True)
class Probing:
    """A body with one circular edge, and the range of approaches that the thesis prints, in degrees from the axis."""

    table: str
    shape: str  #: as virtual-scan names it
    height: float
    radius: float
    low: float
    high: float

    @property
    def centre(self):
        return (self.low + self.high) / 2

    @property
    def half(self):
        return (self.high - self.low) / 2


#: Of the ball, and the largest distance of a reference point from the edge, for tables 5.1 and 5.2.
PROBE_RADIUS, REFERENCE_ERROR = 5, 0.2
PROBING = [
    *(Probing("5.1", "bicone", height, 100, low, high) for height, low, high in (
        (150, 72.1, 107.9), (120, 66.2, 113.8), (100, 58.7, 122.3), (80, 55.2, 124.6), (60, 47.5, 132.5))),
    *(Probing("5.2", "cone-on-hemisphere", height, 100, low, high) for height, low, high in (
        (20, 105.25, 153.45), (50, 105, 137.5), (70, 105.7, 129.3), (100, 112.5, 120.3))),
]

CASES = {
    "hyperboloid": Case("a hyperboloid, points given by a formula", COUNTS["hyperboloid"], HYPERBOLOID.bin_size,
                        HYPERBOLOID.kept, 0, (), 1, 0),
    "face": Case("a face", 13258, 1.2, 1947, 3773, (45, 64, 15), 1, 0),
    "block": Case("a block with five holes, from above", 11521, 3, 978, 1386, BLOCK_SIZE, -4, 5),
    "rhino": Case("a toy rhino", 57835, 2.5, 2538, 4766, (65, 130, 35), 1, 0),
}


@dataclass(frozen=True)
class StandIn:
    """One of our files; only its points are used."""

    case: str
    file: str
    fetched: bool  #: whether `make data` fetches it to build/data; otherwise it is optional
    what: str


STAND_INS = [
    StandIn("face", "meshes/mannequin-devil.off", True,
            "a head with horns, the vertices of a mesh that is open at the neck; the thesis scanned a face from one "
            "side"),
    StandIn("face", "4-open/holes.off", False,
            "a face from one side, the vertices of a mesh with holes; fewer points, so most voxels contain one"),
    StandIn("rhino", "1-bunny/raw/bun000.ply", False, "another animal, one raw scan"),
    StandIn("rhino", "1-bunny/bun_zipper.ply", False, "another animal, merged from ten scans"),
]
