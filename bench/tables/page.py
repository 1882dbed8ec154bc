# SPDX-License-Identifier: GPL-3.0-or-later
"""Generated Markdown, and the JSON behind it."""
import datetime
import json
import pathlib

from harness import machine

ROOT = pathlib.Path(__file__).resolve().parents[2]


def described(command):
    """The command, date, revision and machine of the results."""
    return {
        "format": 1,
        "command": command,
        "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC"),
        "revision": machine.revision(ROOT),
        "machine": machine.described(),
    }


def heading(title, results, source):
    """The first lines of a page: its source, command, date and machine."""
    on = results["machine"]
    return [
        f"<!-- Generated from {source} by `{results['command']}` on {results['date']} on {on['processor']}, "
        f"{on['cores']} cores. Do not edit. -->",
        f"# {title}",
        "",
        f"{results['date']}, {on['processor']}, {on['cores']} cores, {on['memory_gibibytes']} GiB, {on['system']}, "
        f"Linux {on['kernel']}. Scanmill {results['revision']}.",
        "",
    ]


def table(header, rows):
    """The lines of a Markdown table."""
    lines = [header, ["---"] * len(header), *rows]
    return ["| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |" for cells in lines]


def other_load(load):
    """A line with the load by other processes; see harness/machine.py."""
    return (
        f"Other load: {load['others_cores']:.2f} cores by other processes, {load['stolen_cpu_seconds']:.1f} s stolen "
        f"by the hypervisor; the whole bench took {load['took_seconds']:.0f} s."
    )


def json_text(results):
    """JSON with one line per value and one per element of a list, so that diffs are readable."""

    def value_text(value):
        if not isinstance(value, list):
            return json.dumps(value, allow_nan=False)
        return "[\n  " + ",\n  ".join(json.dumps(element, allow_nan=False) for element in value) + "\n ]"

    return "{\n " + ",\n ".join(f"{json.dumps(name)}: {value_text(value)}" for name, value in results.items()) + "\n}\n"


def write(folder, name, results, lines):
    """Writes NAME.json and NAME.md, each whole or not at all."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for suffix, content in ((".json", json_text(results)), (".md", "\n".join(lines).rstrip() + "\n")):
        part = folder / (name + suffix + ".part")
        part.write_text(content)
        part.replace(folder / (name + suffix))
