# SPDX-License-Identifier: GPL-3.0-or-later
"""What Wang 2006 prints of thinning and triangulation, and which of our files stands for which of its scans.

The three clouds that are given by formulas are made anew by wang_clouds.py. Not one of the scans is published.
"""
from dataclasses import dataclass


@dataclass(frozen=True)
class Thinning:
    """A cloud given by a formula, thinned to a tolerance."""

    section: str
    cloud: str  #: by its name in wang_clouds.py
    tolerance: float
    bin_size: float
    kept: int  #: 0: not printed


HEMISPHERE = Thinning("3.6.1", "hemisphere-8", 0.025, 1.2, 223)
CONE = Thinning("3.6.2", "cone", 0.02, 0.103, 0)

#: Counts of points that formulas and steps give.
COUNTS = {"hemisphere-1": 188, "hemisphere-8-coarse": 292, "hemisphere-8": 1376, "cone": 1247, "hyperboloid": 7837}
STEP_DEGREES = 11.46  #: of the hemisphere of radius 1 at a tolerance of 0.005
CONE_CURVATURE = 15.25
HYPERBOLOID_CURVATURE = 1.42
#: The tolerance is ours; the thesis prints none.
HYPERBOLOID = Thinning("4.4.1", "hyperboloid", 0.02, 0.21, 707)
NOSE_TOLERANCE, NOSE_BIN = 0.6, 1.2
BLOCK_SIZE, BLOCK_RADII = (88, 95, 41), (21, 5)


@dataclass(frozen=True)
class Case:
    """A line of section 4.4."""

    what: str
    points: int
    bin_size: float  #: in mm
    kept: int
    facets: int  #: 0: not printed
    box: tuple  #: sides in mm, () where they are not printed
    euler: int  #: vertices less edges plus facets of what is described: 1 for a disc, one less for each hole
    holes: int

    @property
    def bin_share(self):
        """The bin size as a share of the box's diagonal, which scans of other sizes can have too."""
        return self.bin_size / sum(side * side for side in self.box) ** 0.5

    @property
    def boundary_edges(self):
        """That all points in facets leave by Euler's identity, F = 2 V − 2 χ − b; None without facets."""
        return 2 * self.kept - 2 * self.euler - self.facets if self.facets else None


CASES = {
    "hyperboloid": Case("a hyperboloid's points by formula", COUNTS["hyperboloid"], HYPERBOLOID.bin_size,
                        HYPERBOLOID.kept, 0, (), 1, 0),
    "face": Case("a face", 13258, 1.2, 1947, 3773, (45, 64, 15), 1, 0),
    "block": Case("a block with five holes, from above", 11521, 3, 978, 1386, BLOCK_SIZE, -4, 5),
    "rhino": Case("a toy rhino", 57835, 2.5, 2538, 4766, (65, 130, 35), 1, 0),
}


@dataclass(frozen=True)
class StandIn:
    """A file of ours; its points count, whatever else it holds."""

    case: str
    file: str
    fetched: bool  #: below build/data, by `make data`; else among the files that may be there or not
    what: str


STAND_INS = [
    StandIn("face", "meshes/mannequin-devil.off", True,
            "the corners of a mesh of a head with horns, open at the neck; the thesis scanned a face from one side"),
    StandIn("face", "4-open/holes.off", False,
            "the corners of a mesh of a face from one side, with holes; fewer points, so most bins hold one"),
    StandIn("rhino", "1-bunny/raw/bun000.ply", False, "another animal, scanned once, as it came from the scanner"),
    StandIn("rhino", "1-bunny/bun_zipper.ply", False, "another animal, merged from ten scans"),
]
