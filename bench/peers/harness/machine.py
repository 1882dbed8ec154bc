# SPDX-License-Identifier: GPL-3.0-or-later
"""Describes the machine, and the load by other processes during a measurement."""
import os
import platform
import resource
import subprocess
import time


def described():
    return {
        "processor": processor(),
        "cores": len(os.sched_getaffinity(0)),
        "memory_gibibytes": round(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30, 1),
        "kernel": platform.release(),
        "system": system(),
        "python": platform.python_version(),
    }


def processor():
    with open("/proc/cpuinfo") as file:
        for line in file:
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.machine()


def system():
    try:
        with open("/etc/os-release") as file:
            values = dict(line.rstrip("\n").split("=", 1) for line in file if "=" in line)
        return values.get("PRETTY_NAME", "").strip('"')
    except OSError:
        return platform.system()


def revision(root):
    """The git revision of the sources below `root`, with "dirty" if they contain uncommitted changes."""
    ask = ["git", "-C", str(root), "describe", "--always", "--dirty"]
    done = subprocess.run(ask, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    return done.stdout.strip() if done.returncode == 0 else "of an unknown revision"


def busy_and_stolen(line):
    """Busy CPU ticks, and ticks stolen by the hypervisor, from the first line of /proc/stat."""
    user, nice, kernel, _idle, _waiting, interrupts, soft_interrupts, stolen = (int(word) for word in line.split()[1:9])
    return user + nice + kernel + interrupts + soft_interrupts, stolen


def cpu_seconds_of_ours():
    """CPU seconds of this process and of its finished children."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in used)


class Load:
    """Measures the load by other processes from construction to described(). Close all started processes before."""

    def __init__(self):
        self.begin = self._now()

    @staticmethod
    def _now():
        with open("/proc/stat") as file:
            busy, stolen = busy_and_stolen(file.readline())
        ticks = os.sysconf("SC_CLK_TCK")
        return {
            "clock": time.monotonic(),
            "busy": busy / ticks,
            "stolen": stolen / ticks,
            "ours": cpu_seconds_of_ours(),
            "average": os.getloadavg()[0],
        }

    def described(self):
        return between(self.begin, self._now())


def between(begin, end):
    """The load between two readings of Load. The share of others is the busy time minus our own."""
    took = end["clock"] - begin["clock"]
    others = max(0.0, end["busy"] - begin["busy"] - (end["ours"] - begin["ours"]))
    return {
        "took_seconds": round(took, 2),
        "others_cpu_seconds": round(others, 2),
        "others_cores": round(others / took, 3) if took > 0 else 0.0,
        "stolen_cpu_seconds": round(end["stolen"] - begin["stolen"], 2),
        "load_average_before": begin["average"],
        "load_average_after": end["average"],
    }
