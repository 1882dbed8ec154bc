# SPDX-License-Identifier: GPL-3.0-or-later
"""The classes with which a file in rows/ describes a comparison."""
from dataclasses import dataclass, field
from typing import Dict, List, Optional


@dataclass
class Contender:
    """A program that does the work of a row, in its own process."""

    program: str  #: a name of programs.py: "scanmill", "cgal", "open3d"
    work: dict  #: the request that is timed, once per round: {"do": "voxel-thin", "bin-size": 0.01}
    label: str = ""  #: the method, if the program has several: "VoxelGrid"
    threads: Optional[int] = None  #: sent with the work; None: the program has no such setting
    prepare: Optional[dict] = None  #: a request before the measurement, usually to load the input
    differs: str = ""  #: how its work differs from ours; its results are then not checked
    agree: Dict[str, float] = field(default_factory=dict)  #: its own tolerances instead of the row's

    @property
    def name(self):
        return f"{self.program} {self.label}".strip()

    @property
    def ours(self):
        return self.program == "scanmill"


@dataclass
class Row:
    """The same work by several contenders. The first one that reports a fact is the reference for the others."""

    name: str  #: short, for ROWS=: "delaunay-bunny"
    title: str
    inputs: list  #: of inputs.Input; made before the measurement; a missing one fails the row
    contenders: List[Contender]
    equal: str  #: a sentence: what is equal for all contenders
    agree: Dict[str, float]  #: facts that must be equal, with the tolerance as a share of the reference
    #: Names of the filters whose algorithms Scanmill runs here. The record holds their versions.
    filters: List[str] = field(default_factory=list)
    #: Default number of rounds. Slow contenders do fewer: see turns.py.
    rounds: int = 5
    #: Whether one uncounted round precedes the counted rounds.
    warm_up: bool = True
    #: A fact that counts elements: the page also shows the peak memory beyond the input per element.
    peak_per: str = ""
    #: The name of a row with the same contenders on a smaller input: the page shows the ratio of the times.
    grows_from: str = ""


def in_threads(counts, program, work, **more):
    """The same contender once per number of threads."""
    return [Contender(program, work, threads=count, **more) for count in counts]
