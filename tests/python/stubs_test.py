# SPDX-License-Identifier: GPL-3.0-or-later
"""The type stub: Python reads it, and it has every filter and every public name."""
import ast
import importlib.util
import inspect
import subprocess
import sys
import unittest

import scanmill
from scanmill._stubs import stub
from support import InFolder


class Stubs(InFolder):
    def test_every_function_is_there_with_its_parameters(self):
        tree = ast.parse(stub())
        functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
        for name, function in scanmill.filters.items():
            node = functions[name.replace("-", "_")]
            names = [argument.arg for argument in node.args.args + node.args.kwonlyargs]
            self.assertEqual(names, list(inspect.signature(function).parameters))
            self.assertEqual(ast.get_docstring(node), inspect.getdoc(function))
        imported = {alias.asname for node in tree.body if isinstance(node, ast.ImportFrom) for alias in node.names if node.level == 1}
        self.assertEqual(imported, {name for names in scanmill._NAMES.values() for name in names})

    @unittest.skipUnless(importlib.util.find_spec("mypy"), "skipped: needs the package mypy")
    def test_a_type_checker_finds_wrong_calls(self):
        package = self.folder / "stubs/scanmill"
        package.mkdir(parents=True)
        text = "\n".join(line if not line.startswith("from ._") else "" for line in stub().split("\n"))
        for name in (name for names in scanmill._NAMES.values() for name in names):
            text += f"\nclass {name}: ...\n" if name[0].isupper() else f"\n{name}: Any\n"
        (package / "__init__.pyi").write_text(text)
        (self.folder / "right.py").write_text("import scanmill\nscanmill.decimate(scanmill.Mesh(), max_error='1 mm', mode='direct')\n")
        (self.folder / "wrong.py").write_text("import scanmill\nscanmill.decimate(scanmill.Mesh(), mode='indirect')\nscanmill.decimate(scanmill.Mesh(), max_eror=1)\n")
        check = [sys.executable, "-m", "mypy", "--no-incremental"]
        environment = {"MYPYPATH": str(self.folder / "stubs"), "PATH": "/usr/bin"}
        right = subprocess.run([*check, "right.py"], capture_output=True, text=True, env=environment)
        self.assertIn("Success", right.stdout)
        wrong = subprocess.run([*check, "wrong.py"], capture_output=True, text=True, env=environment)
        self.assertIn("Found 2 errors", wrong.stdout)


if __name__ == "__main__":
    unittest.main()
