# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes RESULTS.md from results.json. All text of the page comes from the JSON or from this file."""
from . import figures, filters

NOTES = """\
Columns:

- *seconds*: median over the rounds; every program measures only the work itself
- *least to most*: range over the rounds
- *ours / it*: Scanmill's time divided by the program's time in the same round, median over the rounds; below 1
  Scanmill is faster; with the filter's name where a row has two
- *peak*: peak memory of the program's process during the work, including the input and, for Python, the interpreter
- *cores*: processor time divided by elapsed time
- †: the program does different work, as explained below the table
- ‡: the program should have the same result but has not, so there is no ratio
- *failed*: the program failed, so there is no ratio
- *outdated*: the row measured an older version of the named filter

PDAL has no package in Debian 12 or on PyPI and is not compared."""


def seconds(value):
    return f"{value:.3f}" if value < 10 else f"{value:.1f}"


def number(value):
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return str(value)
    return f"{value:,}" if isinstance(value, int) else f"{value:.6g}"


def result(entry):
    """The facts, then the parts of the time that the program reported."""
    words = [f"{name.replace('_', ' ')} {number(value)}" for name, value in entry["facts"].items()]
    for name, parts in entry["part_seconds"].items():
        words.append(f"{name.replace('_', ' ')} took {seconds(figures.spread(parts)[0])} of the seconds")
    return ", ".join(words)


def threads(entry):
    return str(entry["threads"]) if entry["threads"] else "–"


def ours_column(entry, ours):
    """With the name of the method if several methods are ours."""
    methods = {one["name"] for one in ours}
    whose = entry["name"].removeprefix(entry["program"]).strip() if len(methods) > 1 else "ours"
    return f"{whose} / it, {entry['threads']} thr." if entry["threads"] else f"{whose} / it"


def line(entry, ours):
    """One row of the table."""
    mark = "†" if entry["differs"] else "‡" if entry["unequal"] else ""
    name = f"**{entry['name']}**" if entry["ours"] else entry["name"] + mark
    if not figures.counts(entry):
        return [name, threads(entry), "failed", "", "", *("" for _ in ours), "", "", entry["failure"] or "no round"]
    middle, least, most = figures.spread(entry["seconds"])
    cells = [name, threads(entry), seconds(middle), f"{seconds(least)} to {seconds(most)}", str(len(entry["seconds"]))]
    for own in ours:
        ratio = None if entry["ours"] else figures.ratio(own, entry)
        cells.append(f"{ratio[0]:.2f}" if ratio else "")
    cores, peak = figures.cores(entry), entry["peak_mebibytes"]
    cells.append(f"{peak:.0f} MiB" if peak is not None else "")
    cells.append(f"{cores:.1f}" if cores is not None else "")
    return cells + [result(entry)]


def called(entry):
    return entry["name"] + (f", {entry['threads']} threads" if (entry["threads"] or 1) > 1 else "")


def points(row):
    return row["inputs"][0].get("points", 0) if row["inputs"] else 0


def growths(row, smaller):
    """Ratio of each contender's time to that on the smaller input of another row."""
    before = {called(entry): entry for entry in smaller["contenders"]}
    ratios = [(called(entry), figures.growth(entry, before[called(entry)]))
            for entry in row["contenders"] if called(entry) in before]
    words = [f"{who} {times:.1f} times" for who, times in ratios if times]
    if words and points(smaller):
        yield (f"Time compared with `{smaller['name']}`, at {points(row) / points(smaller):.1f} times the points: "
               f"{', '.join(words)}")


def memory(row):
    """One line with the peak memory per element."""
    fact = row.get("peak_per", "")
    peaks = [(called(entry), figures.bytes_per(entry, fact)) for entry in row["contenders"]]
    words = [f"{who} {per:.0f}" for who, per in peaks if per is not None]
    if words:
        yield f"Bytes of peak memory beyond the loaded input, per element of {fact}: {', '.join(words)}"


def remarks(row, smaller=None):
    """Remarks below the table. If a row compares no results, its `equal` explains why."""
    compares = row.get("compares", True) and len(row["contenders"]) > 1
    for entry in row["contenders"]:
        who = called(entry)
        if entry["differs"]:
            yield f"† {who}: {entry['differs']}"
        if entry["unequal"]:
            yield f"‡ {who}: {entry['unequal']}"
        if compares and not entry["failure"] and not entry["differs"] and not entry["checked"]:
            yield f"{who}: no fact of its result was compared with another program"
        if entry["varied"]:
            yield f"{who}: differs between rounds: {', '.join(entry['varied'])}"
        if entry["peak_counts_loading"] and entry["peak_mebibytes"] is not None:
            yield f"{who}: its peak includes loading the input"
    yield from memory(row)
    if smaller:
        yield from growths(row, smaller)
    load = row["load"]
    yield (
        f"Other load: {load['others_cores']:.2f} cores by other processes, {load['stolen_cpu_seconds']:.1f} s stolen "
        f"by the hypervisor, load average {load['load_average_before']:.1f} to {load['load_average_after']:.1f}; "
        f"the row took {load['took_seconds']:.0f} s"
    )


def section(row, smaller=None):
    """`smaller` is the record of the row named by grows_from, if that ran too."""
    lines = [f"## {row['title']}", "", f"`ROWS={row['name']}`"]
    old = filters.outdated(row)
    if old:
        lines[2:2] = [f"**outdated**: {', '.join(old)}", ""]
    for one in row["inputs"]:
        counts = ", ".join(f"{value:,} {name}" for name, value in one.items() if name != "what")
        lines[-1] += f" · {one['what']}" + (f": {counts}" if counts else "")
    if row["filters"]:
        lines[-1] += " · version " + ", ".join(f"{number} of {name}" for name, number in row["filters"].items())
    if "revision" in row:
        lines[-1] += f" · measured by itself on {row['date']}, Scanmill {row['revision']}"
    lines += ["", f"Equal: {row['equal']}", ""]
    if row["failure"]:
        return lines[:-2] + ["", f"**failed**: {row['failure']}", ""]
    ours = [entry for entry in row["contenders"] if entry["ours"]]
    header = ["program", "threads", "seconds", "least to most", "rounds"]
    header += [ours_column(entry, ours) for entry in ours]
    header += ["peak", "cores", "result"]
    rows = [header, ["---"] * len(header)] + [line(entry, ours) for entry in row["contenders"]]
    lines += ["| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |" for cells in rows]
    return lines + [""] + [f"- {remark}" for remark in remarks(row, smaller)] + [""]


def page(results):
    """The text of RESULTS.md."""
    machine = results["machine"]
    lines = [
        f"<!-- Generated from results.json by `{results['command']}` on {results['date']} on {machine['processor']}, "
        f"{machine['cores']} cores. Do not edit. -->",
        "# Scanmill compared with other programs",
        "",
        f"{results['date']}, {machine['processor']}, {machine['cores']} cores, {machine['memory_gibibytes']} GiB, "
        f"{machine['system']}, Linux {machine['kernel']}.",
        f"Scanmill {results['revision']}. "
        + ", ".join(f"{name} {version}" for name, version in sorted(results["versions"].items())) + ".",
        "",
        NOTES,
        "",
    ]
    ran = {row["name"]: row for row in results["rows"] if not row["failure"]}
    for row in results["rows"]:
        lines += section(row, ran.get(row.get("grows_from")))
    return "\n".join(lines).rstrip() + "\n"
