# SPDX-License-Identifier: GPL-3.0-or-later
"""A page with files and commands, as tests/support/guide.hpp follows it: … stands for any text in a line, or for any lines."""
import pathlib
import re
import shlex

from roots import Root


class Guide:
    def __init__(self, page: pathlib.Path):
        text = page.read_text(encoding="utf-8")
        self.files = re.findall(r"<!-- file: (.*?) -->\n```\w*\n(.*?)```\n", text, re.DOTALL)
        self.commands: list[tuple[str, list[str]]] = []
        for block in re.findall(r"<!-- run -->\n```console\n(.*?)```\n", text, re.DOTALL):
            for line in block.splitlines():
                if line.startswith("$ "):
                    self.commands.append((line[2:], []))
                else:
                    self.commands[-1][1].append(line)

    def follow(self, root: Root, folder: str, environment: dict[str, str]) -> None:
        """Writes the files into the folder and runs the commands there, in one shell."""
        for name, content in self.files:
            file = root.path / folder.lstrip("/") / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(content, encoding="utf-8")
        # The package is where the caller says, not where the page installs it.
        separator = "==== end of command"
        script = f"cd {shlex.quote(folder)}\n" + "".join(
            f"{command.replace(' -DCMAKE_PREFIX_PATH=$HOME/scanmill', '')}\necho '{separator}'\n" for command, _ in self.commands)
        done = root.run(f"set -e; exec 2>&1\n{script}", environment={"LANG": "C.UTF-8", **environment})
        printed = done.stdout.split(f"{separator}\n")
        for (command, expected), found in zip(self.commands, printed):
            pattern = "".join("(.*\n)*" if line == "…" else re.escape(line).replace("…", ".*") + "\n" for line in expected)
            if not re.fullmatch(pattern, found):
                raise AssertionError(f"$ {command}\nprinted\n{found}\nexpected\n" + "\n".join(expected))
        if done.returncode != 0:
            raise AssertionError(done.stdout)
