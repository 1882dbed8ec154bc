# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a row. Every contender has its own process, and all work in turn, so that other load on the machine affects all
of them equally."""
from . import agreement, filters
from .inputs import Missing
from .machine import Load
from .process import Failure, Process

#: Every contender does at least this many counted rounds, whatever its budget, because one round has no spread.
FEWEST_ROUNDS = 2


class Options:
    """limit: seconds for one answer. budget: seconds of counted work after which a contender skips the other rounds."""

    def __init__(self, rounds=None, limit=300.0, budget=20.0):
        self.rounds, self.limit, self.budget = rounds, limit, budget


class Turn:
    """A contender during its row. `entry` is its record."""

    def __init__(self, contender, command):
        self.contender = contender
        self.command = command
        self.process = None
        self.spent = 0.0
        self.entry = {
            "name": contender.name,
            "program": contender.program,
            "threads": contender.threads,
            "ours": contender.ours,
            "differs": contender.differs,
            "failure": "",
            "warm_up_seconds": None,
            "seconds": [],
            "cpu_seconds": 0.0,
            "resident_mebibytes_before": None,
            "peak_mebibytes": None,
            "peak_counts_loading": False,
            "part_seconds": {},
            "facts": {},
            "varied": [],
        }

    def out(self, options):
        done = len(self.entry["seconds"])
        return bool(self.entry["failure"]) or (self.spent > options.budget and done >= FEWEST_ROUNDS)

    def attempt(self, step, *arguments):
        """Runs a step and records its failure, so that the other contenders continue."""
        try:
            step(*arguments)
        except Failure as failure:
            self.entry["failure"] = str(failure)

    def start(self, limit):
        self.process = Process(self.command)
        if self.contender.prepare:
            self.process.ask(self.contender.prepare, limit)
        self.entry["resident_mebibytes_before"] = self.process.resident_mebibytes()
        self.entry["peak_counts_loading"] = not self.process.reset_peak()

    def work(self, counted, limit):
        request = dict(self.contender.work)
        if self.contender.threads is not None:
            request["threads"] = self.contender.threads
        cpu = self.process.cpu_seconds()
        answer = self.process.time(request, limit)
        self.entry["peak_mebibytes"] = self.process.peak_mebibytes()
        parts = {name: value for name, value in answer.items() if name.endswith("_seconds")}
        self._keep_facts({name: value for name, value in answer.items() if name != "seconds" and name not in parts})
        if counted:
            self.spent += answer["seconds"]
            self.entry["seconds"].append(answer["seconds"])
            for name, value in parts.items():
                self.entry["part_seconds"].setdefault(name.removesuffix("_seconds"), []).append(value)
            self.entry["cpu_seconds"] += self.process.cpu_seconds() - cpu
        else:
            self.entry["warm_up_seconds"] = answer["seconds"]

    def _keep_facts(self, facts):
        """Keeps the facts of the first round, and the names of facts that change later."""
        if not self.entry["facts"]:
            self.entry["facts"] = facts
        changed = [name for name in facts if facts[name] != self.entry["facts"].get(name)]
        self.entry["varied"] = sorted({*self.entry["varied"], *changed})

    def close(self):
        if self.process:
            self.process.close()


def run(row, command_of, options):
    """Returns the record of the row. command_of(program) gives the command line that starts a program."""
    record = {"name": row.name, "title": row.title, "equal": row.equal, "rounds": options.rounds or row.rounds}
    record["compares"] = bool(row.agree)
    record.update(peak_per=row.peak_per, grows_from=row.grows_from)
    record["filters"] = {name: filters.version(name) for name in row.filters}
    record.update(failure="", inputs=[], contenders=[])
    try:
        for one in row.inputs:
            one.make()
            record["inputs"].append({"what": one.describe, **one.facts})
    except Missing as missing:
        return {**record, "failure": str(missing), "load": None}
    load = Load()
    turns = [Turn(contender, command_of(contender.program)) for contender in row.contenders]
    try:
        for turn in turns:
            turn.attempt(turn.start, options.limit)
        for number in range(-1 if row.warm_up else 0, record["rounds"]):
            for turn in turns:
                if not turn.out(options):
                    turn.attempt(turn.work, number >= 0, options.limit)
    finally:
        for turn in turns:
            turn.close()
    record["load"] = load.described()
    record["contenders"] = [turn.entry for turn in turns]
    agreement.check(row, record["contenders"])
    return record
