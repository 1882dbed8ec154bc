# SPDX-License-Identifier: GPL-3.0-or-later
"""Replaces this process by the program, which gets the arguments, the signals and the files and gives the exit code."""
import os
import sys

from scanmill import prefix


def main() -> None:
    program = os.path.join(prefix, "bin", "scanmill")
    try:
        os.execv(program, ["scanmill", *sys.argv[1:]])
    except OSError as error:
        hints = {
            FileNotFoundError: "install the package again: pip install --force-reinstall, with the same wheel",
            PermissionError: "install the package on a file system that is not mounted with noexec",
        }
        print(f"error: '{program}' cannot be started: {error.strerror}", file=sys.stderr)
        if type(error) in hints:
            print(f"hint: {hints[type(error)]}", file=sys.stderr)
        sys.exit(3)


if __name__ == "__main__":
    main()
