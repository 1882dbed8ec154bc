# SPDX-License-Identifier: GPL-3.0-or-later
"""A program that answers requests: one JSON object per line in, one per line out."""
import json
import math
import os
import select
import signal
import subprocess
import tempfile
import time

MEBIBYTE = 1024 * 1024


class Failure(Exception):
    """The reason why a contender failed: the text of an exception, a signal, a time limit. One sentence."""


class Process:
    def __init__(self, command):
        self.complaints = tempfile.TemporaryFile()
        self.unread = b""
        try:
            self.process = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.complaints
            )
        except OSError as error:
            self.complaints.close()
            raise Failure(f"{command[0]} cannot be started: {error.strerror}") from None

    def ask(self, request, limit):
        """Returns the answer as a dictionary. Raises Failure. Kills the program after the time limit."""
        try:
            self.process.stdin.write(json.dumps(request).encode() + b"\n")
            self.process.stdin.flush()
        except OSError:
            raise Failure(self._reason_of_end()) from None
        line = self._line(limit)
        try:
            answer = json.loads(line)
        except ValueError:
            answer = None
        if not isinstance(answer, dict):
            raise Failure(f"answered {line[:80]!r}, which is not a JSON object")
        if "failed" in answer:
            raise Failure(answer["failed"])
        return answer

    def time(self, request, limit):
        """Like ask(). The answer contains the seconds that the program measured for its work."""
        answer = self.ask(request, limit)
        seconds = answer.get("seconds")
        if not isinstance(seconds, (int, float)) or not math.isfinite(seconds) or seconds <= 0:
            raise Failure(f"measured {seconds!r} seconds, which is not a valid time")
        return answer

    def _line(self, limit):
        end = time.monotonic() + limit
        stream = self.process.stdout.fileno()
        while b"\n" not in self.unread:
            ready, _, _ = select.select([stream], [], [], max(0.0, end - time.monotonic()))
            if not ready:
                self.kill()
                raise Failure(f"no answer within {limit:g} s")
            some = os.read(stream, 1 << 16)
            if not some:
                raise Failure(self._reason_of_end())
            self.unread += some
        line, _, self.unread = self.unread.partition(b"\n")
        return line.decode(errors="replace")

    def _reason_of_end(self):
        """How the program ended, and its last line on standard error."""
        status = self.process.wait()
        how = f"ended with {status}" if status >= 0 else f"killed by {signal.Signals(-status).name}"
        self.complaints.seek(0)
        words = [line.strip() for line in self.complaints.read().decode(errors="replace").splitlines() if line.strip()]
        return f"{how}: {words[-1][:200]}" if words else how

    def reset_peak(self):
        """Resets the peak of peak_mebibytes(). Returns whether the system allows it."""
        try:
            with open(f"/proc/{self.process.pid}/clear_refs", "w") as file:
                file.write("5")
        except OSError:
            return False
        return True

    def peak_mebibytes(self):
        return self._status("VmHWM")

    def resident_mebibytes(self):
        return self._status("VmRSS")

    def _status(self, name):
        """None after the program has ended."""
        try:
            with open(f"/proc/{self.process.pid}/status") as file:
                for line in file:
                    if line.startswith(name + ":"):
                        return int(line.split()[1]) * 1024 / MEBIBYTE
        except OSError:
            pass
        return None

    def cpu_seconds(self):
        """CPU seconds of all its threads so far; 0 after it has ended."""
        try:
            with open(f"/proc/{self.process.pid}/stat") as file:
                words = file.read().rpartition(")")[2].split()
        except OSError:
            return 0.0
        return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK") if len(words) > 12 else 0.0

    def kill(self):
        self.process.kill()
        self.process.wait()

    def close(self):
        """Closes the program's input, and kills the program if it does not end."""
        try:
            self.process.stdin.close()
        except OSError:
            pass  # unsent requests to a program that has ended
        try:
            self.process.wait(timeout=20)
        except subprocess.TimeoutExpired:
            self.kill()
        self.process.stdout.close()
        self.complaints.close()
