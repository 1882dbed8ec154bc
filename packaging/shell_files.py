#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""shell_files.py PROGRAM FOLDER: writes the manual page and the completion scripts into FOLDER, in the places that they have
below share/. The manual page follows from the program's help, and the exit codes from docs/reference/command.md."""
import gzip
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
COMPLETIONS = {
    "bash": "bash-completion/completions/scanmill",
    "zsh": "zsh/vendor-completions/_scanmill",
    "fish": "fish/vendor_completions.d/scanmill.fish",
}
ENVIRONMENT = {
    "SCANMILL_PLUGIN_PATH": "Absolute folders with further filters, separated by colons. They are searched after the program's own folder.",
    "XDG_CACHE_HOME": "The cache is in the folder scanmill below it. Default: ~/.cache.",
    "TMPDIR": "Values of runs without a cache are kept below this folder.",
}


def output_of(*command: str) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


class Help:
    """What `--help` prints: a summary, sections of entries, and what follows them."""

    def __init__(self, text: str):
        lines = text.splitlines()
        usage = next(i for i, line in enumerate(lines) if line.startswith("Usage: "))
        self.summary = " ".join(lines[:usage]).strip()
        self.usage = lines[usage].removeprefix("Usage: ")
        self.sections: dict[str, list[list[str]]] = {}
        self.footer: list[str] = []
        entries: list[list[str]] | None = None
        for line in lines[usage + 1 :]:
            if re.fullmatch(r"\w+:", line):
                entries = self.sections.setdefault(line[:-1], [])
            elif line.startswith("      ") and entries:
                entries[-1][1] = (entries[-1][1] + " " + line.strip()).strip()
            elif line.startswith("  ") and entries is not None:
                name, _, help_text = line.strip().partition("  ")
                entries.append([name, help_text.strip()])
            elif line.strip():
                self.footer.append(line)


def escaped(text: str) -> str:
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("…", "...").replace("`", "")
    return "\\&" + text if text[:1] in ".'" else text


def entry_lines(name: str, help_text: str) -> list[str]:
    """An option or argument as a tagged paragraph; what excludes it becomes a sentence."""
    name, _, excluded = name.partition(" Excludes: ")
    name = re.sub(r"(\w+):(UINT in )?\[(\S+) - (\S+)\]", r"\1", name).replace("UINT", "NUMBER").replace("INT", "NUMBER")
    name = re.sub(r"TEXT:\{([^}]*)\}", lambda words: words[1].replace(",", "|"), name)
    name = name.replace(" REQUIRED", "")
    options = ", ".join(f"\\fB{escaped(option)}\\fR" for option in name.split()[0].split(","))
    value = " ".join(name.split()[1:])
    default = re.search(r"=([^|\s]+)$", value or "")
    if default:
        value = value[: default.start()]
        if "Default" not in help_text:
            help_text = help_text.rstrip(".") + f". Default: {default[1]}"
    if not name.startswith("-") and value in ("TEXT", "TEXT ..."):
        value = "..." if "..." in value else ""
    if excluded:
        help_text = help_text.rstrip(".") + f". Not with {', '.join(excluded.split())}."
    return [".TP", options + (f" \\fI{escaped(value)}\\fR" if value else ""), escaped(help_text)]


def exit_codes() -> list[str]:
    table = (ROOT / "docs/reference/command.md").read_text().split("## Exit codes")[1].split("\n## ")[0]
    lines = []
    for code, meaning in re.findall(r"^\| (\d+) \| (.*) \|$", table, re.MULTILINE):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", meaning)
        lines += [".TP", f"\\fB{code}\\fR", escaped(plain)]
    return lines


def manual_page(program: str) -> str:
    top = Help(output_of(program, "--help"))
    version = output_of(program, "--version").strip()
    page = [
        f'.TH SCANMILL 1 "" "{version}" "User Commands"',
        ".SH NAME", "scanmill \\- turn libraries of 3D scans into surfaces",
        ".SH SYNOPSIS", "\\fBscanmill\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR] [\\fIARGUMENTS\\fR]",
        ".SH DESCRIPTION", escaped(top.summary),
        "A workflow, a YAML file, chains filters. The command checks it before it opens any scan,",
        "runs it over one scan or many, and records what it did.",
        ".SH EXAMPLE", ".nf", "scanmill run quickstart scan.ply \\-o meshes", ".fi",
        ".SH OPTIONS", ".TP", "\\fB\\-\\-help\\fR", "Print help, of the program or of a command.",
        ".TP", "\\fB\\-\\-version\\fR", "Print the version.",
        ".SH COMMANDS",
    ]
    for name, _ in top.sections["Subcommands"]:
        command = Help(output_of(program, name, "--help"))
        page += [f'.SS "{escaped(command.usage.replace(" [OPTIONS]", "").removeprefix("scanmill "))}"', escaped(command.summary + ".")]
        for section in ("Positionals", "Options"):
            for entry, help_text in command.sections.get(section, []):
                if "--help" not in entry:
                    page += entry_lines(entry, help_text)
        for entry, help_text in command.sections.get("Subcommands", []):
            page += [".TP", f"\\fB{escaped(f'{name} {entry}')}\\fR", escaped(help_text)]
        for line in command.footer:
            page += [".PP", escaped(line)]
    page += [".SH EXIT STATUS", *exit_codes(), ".SH ENVIRONMENT"]
    for variable, help_text in ENVIRONMENT.items():
        page += [".TP", f"\\fB{variable}\\fR", escaped(help_text)]
    return "\n".join(page) + "\n"


def main() -> None:
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    files = {name: output_of(program, "completion", shell).encode() for shell, name in COMPLETIONS.items()}
    files["man/man1/scanmill.1.gz"] = gzip.compress(manual_page(program).encode(), mtime=0)
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)


if __name__ == "__main__":
    main()
