# SPDX-License-Identifier: GPL-3.0-or-later
"""How a file in rows/ says what is to be compared."""
from dataclasses import dataclass, field
from typing import Dict, List, Optional


@dataclass
class Contender:
    """One program that does a row's work, in a process of its own."""

    program: str  #: a name of programs.py: "scanmill", "cgal", "open3d"
    work: dict  #: the request that is timed, once per round: {"do": "voxel-thin", "bin-size": 0.01}
    label: str = ""  #: which of the program's ways, when it has several: "VoxelGrid"
    threads: Optional[int] = None  #: sent along with the work; None: the program has no such setting
    prepare: Optional[dict] = None  #: a request before the clock and the memory count, usually to load the input
    differs: str = ""  #: what this program does otherwise than ours; its results are then not checked
    agree: Dict[str, float] = field(default_factory=dict)  #: its own tolerances instead of the row's

    @property
    def name(self):
        return f"{self.program} {self.label}".strip()

    @property
    def ours(self):
        return self.program == "scanmill"


@dataclass
class Row:
    """The same work by several contenders. The first one that tells a fact is who the others are compared with."""

    name: str  #: short, for ROWS=: "delaunay-bunny"
    title: str
    inputs: list  #: of inputs.Input; made before the clock runs, and a missing one fails the row
    contenders: List[Contender]
    equal: str  #: a sentence: what is equal for all of them
    agree: Dict[str, float]  #: facts of the answers that must be equal, within this share of the first one's
    #: Rounds when the command line names none. Slow contenders do fewer: see turns.py.
    rounds: int = 5
    #: One round before the counted ones. Without it the first time a program does its work counts.
    warm_up: bool = True
    #: A fact that counts elements: what the peak adds to the loaded input is told per element as well.
    peak_per: str = ""
    #: The name of a row with the same contenders on a smaller input: how much longer this one takes is told.
    grows_from: str = ""


def in_threads(counts, program, work, **more):
    """The same contender once per number of threads."""
    return [Contender(program, work, threads=count, **more) for count in counts]
