# SPDX-License-Identifier: GPL-3.0-or-later
"""The command lines of the benches."""
import contextlib
import io
import pathlib
import unittest

from tables import options


def parsed(words, refused=None):
    """The options; or, when `refused`, what is said of words that are none."""
    parser = options.of_a_table("A bench.", pathlib.Path("w.yaml"), 60, "quality")
    parser.add_argument("--rounds", type=options.at_least_one, default=5)
    if not refused:
        return parser.parse_args(words)
    said = io.StringIO()
    with contextlib.redirect_stderr(said):
        try:
            parser.parse_args(words)
        except SystemExit as end:
            return end.code, said.getvalue()
    return 0, ""


class OptionsTest(unittest.TestCase):
    def test_defaults_lie_in_the_tree(self):
        found = parsed(["scanmill"])
        root = pathlib.Path(options.__file__).resolve().parents[2]
        self.assertEqual(found.data, root / "build" / "data")
        self.assertEqual(found.into, root / "bench" / "quality")
        self.assertEqual((found.workflow, found.limit, found.rounds), (pathlib.Path("w.yaml"), 60, 5))

    def test_what_is_given_counts(self):
        found = parsed(["p", "--rounds", "1", "--limit", "2.5", "--into", "here", "--data", "d", "--workflow", "v.yaml"])
        self.assertEqual((found.rounds, found.limit), (1, 2.5))
        self.assertEqual([str(path) for path in (found.program, found.into, found.data, found.workflow)],
                         ["p", "here", "d", "v.yaml"])

    def test_less_than_one_round_is_refused_by_its_name(self):
        for text, why in (("0", "must be at least 1, not 0"), ("-3", "must be at least 1, not -3"),
                          ("1.5", "'1.5' is not a whole number")):
            code, said = parsed(["p", f"--rounds={text}"], refused=True)
            self.assertEqual(code, 2)
            self.assertIn(f"argument --rounds: {why}", said)


if __name__ == "__main__":
    unittest.main()
