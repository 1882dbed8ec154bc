# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the same work in several programs in turn, so that whatever else the machine does falls on all of them."""
import statistics
import subprocess


class Contender:
    """A program that works on demand: one request per line in, one answer per line out."""

    def __init__(self, name, command):
        self.name = name
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def ask(self, request):
        """The seconds and the other words of the answer; (None, why) after a failure, also the program's own death."""
        if self.process.poll() is not None:
            return None, [f"ended with {self.process.returncode}"]
        try:
            print(request, file=self.process.stdin, flush=True)
            words = self.process.stdout.readline().split()
        except BrokenPipeError:
            words = []
        if not words:
            return None, [f"ended with {self.process.wait()}"]
        return (None, words[1:]) if words[0] == "failed" else (float(words[0]), words[1:])

    def close(self):
        self.process.stdin.close()
        self.process.wait()


class Row:
    """The same work by several contenders: seconds of every round, or why one failed."""

    def __init__(self, title, names):
        self.title = title
        self.seconds = {name: [] for name in names}
        self.results = {}
        self.failures = {}

    def add(self, name, seconds, words):
        if seconds is None:
            self.failures[name] = " ".join(words)
        else:
            self.seconds[name].append(seconds)
            self.results[name] = " ".join(words)

    def ratio(self, name, other):
        """Median, least and most of name's seconds over other's, round by round."""
        ratios = [a / b for a, b in zip(self.seconds[name], self.seconds[other])]
        return statistics.median(ratios), min(ratios), max(ratios)

    def text(self, ours):
        lines = [self.title]
        for name, seconds in self.seconds.items():
            if name in self.failures:
                lines.append(f"  {name:<9} failed: {self.failures[name]}")
                continue
            line = f"  {name:<9} {1e3 * statistics.median(seconds):8.1f} ms"
            line += f"  ({1e3 * min(seconds):.1f} to {1e3 * max(seconds):.1f})"
            if name != ours and ours not in self.failures:
                line += "   {} / {}: {:.2f} ({:.2f} to {:.2f})".format(ours, name, *self.ratio(ours, name))
            lines.append(f"{line}   {self.results[name]}")
        return "\n".join(lines)


def run_in_turn(row, contenders, rounds, work):
    """work(contender) gives (seconds, words). One round before the counted ones warms every contender up."""
    for round_number in range(rounds + 1):
        for contender in contenders:
            if contender.name in row.failures:
                continue
            seconds, words = work(contender)
            if round_number > 0 or seconds is None:
                row.add(contender.name, seconds, words)
