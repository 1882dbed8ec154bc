# SPDX-License-Identifier: GPL-3.0-or-later
"""The page on Python: its blocks run as one program, and print what the page shows."""
import contextlib
import io
import re
import unittest

from support import ROOT, InFolder

PAGE = ROOT / "docs/how-to/use-from-python.md"


class Guide(InFolder):
    def test_the_blocks_print_what_the_page_shows(self):
        blocks = re.findall(r"^```python\n(.*?)^```\n(?:```text\n(.*?)^```\n)?", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
        self.assertGreater(len(blocks), 6)
        names: dict = {"__name__": "guide"}
        for code, shown in blocks:
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                exec(compile(code, str(PAGE), "exec"), names)
            self.assertEqual(printed.getvalue(), shown, code)


if __name__ == "__main__":
    unittest.main()
