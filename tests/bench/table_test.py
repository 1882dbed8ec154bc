# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures by hand, and the page that a small results.json gives."""
import pathlib
import tempfile
import unittest
from unittest import mock

from harness import figures, filters, machine, table
from run import merged, trouble


def entry(name, seconds, **more):
    values = {
        "name": name, "program": name, "threads": None, "ours": name == "scanmill", "differs": "", "failure": "",
        "unequal": "", "checked": 1, "warm_up_seconds": 1.0, "seconds": seconds, "cpu_seconds": sum(seconds),
        "resident_mebibytes_before": 1.0, "peak_mebibytes": 10.0, "peak_counts_loading": False, "facts": {"kept": 1234},
        "part_seconds": {}, "varied": [],
    }
    return {**values, **more}


def results(entries, failure=""):
    load = {
        "took_seconds": 9.0, "others_cpu_seconds": 4.5, "others_cores": 0.5, "stolen_cpu_seconds": 0.0,
        "load_average_before": 1.0, "load_average_after": 2.0,
    }
    row = {
        "name": "thin", "title": "Thinning", "equal": "the points", "failure": failure, "rounds": 3, "load": load,
        "filters": {},
        "inputs": [{"what": "a torus", "points": 1000}], "contenders": entries,
    }
    return {
        "format": 1, "command": "make bench-peers", "date": "2026-01-02 03:04 UTC", "revision": "abc",
        "machine": {
            "processor": "Abacus", "cores": 2, "memory_gibibytes": 4, "kernel": "6.1", "system": "Debian",
            "python": "3",
        },
        "versions": {"PCL": "1.13"}, "rows": [row],
    }


def line_of(page, name):
    return next(line for line in page.splitlines() if line.startswith(f"| {name}"))


class FiguresTest(unittest.TestCase):
    def test_spread_is_median_least_and_most(self):
        self.assertEqual(figures.spread([5.0, 1.0, 2.0]), (2.0, 1.0, 5.0))
        self.assertEqual(figures.spread([4.0, 1.0, 2.0, 3.0]), (2.5, 1.0, 4.0))

    def test_ratio_is_taken_round_by_round(self):
        # 1/2, 2/8 and 9/9: neither the ratio of the medians, 2/8, nor of the sums, 12/19.
        ours, other = entry("scanmill", [1.0, 2.0, 9.0]), entry("pcl", [2.0, 8.0, 9.0])
        self.assertEqual(figures.ratio(ours, other), (0.5, 0.25, 1.0))

    def test_ratio_takes_the_rounds_that_both_did(self):
        ours, other = entry("scanmill", [1.0, 1.0, 9.0]), entry("pcl", [2.0, 4.0])
        self.assertEqual(figures.ratio(ours, other), (0.375, 0.25, 0.5))

    def test_who_failed_or_did_other_work_has_no_ratio(self):
        ours = entry("scanmill", [1.0])
        killed, idle = entry("pcl", [1.0], failure="killed"), entry("pcl", [])
        for other in (killed, idle, entry("pcl", [1.0], unequal="kept is 2")):
            self.assertIsNone(figures.ratio(ours, other))
            self.assertIsNone(figures.ratio({**other, "ours": True}, entry("pcl", [1.0])))

    def test_cores_are_processor_time_over_time(self):
        self.assertEqual(figures.cores(entry("a", [1.0, 1.0], cpu_seconds=3.0)), 1.5)
        self.assertIsNone(figures.cores(entry("a", [0.1])))

    def test_bytes_are_counted_beyond_the_loaded_input(self):
        one = entry("scanmill", [1.0], resident_mebibytes_before=10.0, peak_mebibytes=14.0, facts={"cells": 2**20})
        self.assertEqual(figures.bytes_per(one, "cells"), 4.0)
        for unknown in ({"peak_mebibytes": None}, {"peak_counts_loading": True}, {"failure": "gone"}, {"facts": {}}):
            self.assertIsNone(figures.bytes_per({**one, **unknown}, "cells"))

    def test_growth_is_the_ratio_of_the_medians(self):
        large, small = entry("scanmill", [30.0, 10.0, 20.0]), entry("scanmill", [2.0])
        self.assertEqual(figures.growth(large, small), 10.0)
        self.assertIsNone(figures.growth(large, entry("scanmill", [2.0], failure="gone")))

    def test_busy_time_leaves_out_idle_waiting_and_stolen(self):
        self.assertEqual(machine.busy_and_stolen("cpu  1 2 4 1000 1000 8 16 32 64 128"), (31, 32))

    def test_load_of_others_is_what_was_busy_less_ours(self):
        begin = {"clock": 10.0, "busy": 100.0, "stolen": 1.0, "ours": 5.0, "average": 0.5}
        end = {"clock": 14.0, "busy": 107.0, "stolen": 1.5, "ours": 8.0, "average": 1.5}
        load = machine.between(begin, end)
        self.assertEqual((load["took_seconds"], load["others_cpu_seconds"], load["others_cores"]), (4.0, 4.0, 1.0))
        self.assertEqual(load["stolen_cpu_seconds"], 0.5)


class PageTest(unittest.TestCase):
    def page(self, *entries, **more):
        return table.page(results(list(entries), **more))

    def test_first_line_says_what_made_it_when_and_where(self):
        first = self.page(entry("scanmill", [1.0])).splitlines()[0]
        for word in ("Generated", "make bench-peers", "2026-01-02 03:04 UTC", "Abacus", "2 cores"):
            self.assertIn(word, first)

    def test_line_shows_median_spread_rounds_ratio_memory_cores_and_result(self):
        page = self.page(entry("scanmill", [1.0, 2.0, 3.0]), entry("pcl", [2.0, 4.0, 12.0]))
        expected = "| pcl | – | 4.000 | 2.000 to 12.0 | 3 | 0.50 | 10 MiB | 1.0 | kept 1,234 |"
        self.assertEqual(line_of(page, "pcl"), expected)
        self.assertIn("| **scanmill** | – | 2.000 | 1.000 to 3.000 | 3 |  | 10 MiB |", page)

    def test_part_of_the_time_is_shown_by_its_median(self):
        parts = {"building": [0.5, 0.25, 0.75]}
        page = self.page(entry("pcl", [1.0, 2.0, 3.0], part_seconds=parts))
        self.assertIn("| kept 1,234, building took 0.500 of the seconds |", line_of(page, "pcl"))

    def test_every_one_of_ours_has_its_column(self):
        ours = [entry("scanmill", [seconds], threads=threads) for seconds, threads in ((4.0, 1), (2.0, 2))]
        page = self.page(*ours, entry("pcl", [4.0]))
        self.assertIn("| ours / it, 1 thr. | ours / it, 2 thr. |", page)
        self.assertIn("| 1 | 1.00 | 0.50 |", line_of(page, "pcl"))

    def test_columns_of_ratios_name_the_method_if_several_are_ours(self):
        ours = [entry(f"scanmill {method}", [4.0], program="scanmill", ours=True) for method in ("grow", "cluster")]
        page = self.page(*ours, entry("pcl", [4.0]))
        self.assertIn("| grow / it | cluster / it |", page)

    def test_failure_is_shown_with_why_and_counts_for_nobody(self):
        page = self.page(entry("scanmill", [1.0]), entry("pcl", [9.0], failure="killed by SIGSEGV"))
        self.assertEqual(line_of(page, "pcl"), "| pcl | – | failed |  |  |  |  |  | killed by SIGSEGV |")

    def test_our_failure_leaves_no_ratio(self):
        page = self.page(entry("scanmill", [], failure="no answer within 5 s"), entry("pcl", [9.0]))
        self.assertIn("| pcl | – | 9.000 | 9.000 to 9.000 | 1 |  | 10 MiB |", page)

    def test_other_work_is_marked_and_said(self):
        page = self.page(entry("scanmill", [1.0]), entry("pcl", [2.0], differs="makes centroids"))
        self.assertIn("| pcl† |", page)
        self.assertIn("- † pcl: makes centroids", page)

    def test_unequal_result_is_marked_said_and_has_no_ratio(self):
        page = self.page(entry("scanmill", [1.0]), entry("pcl", [2.0], unequal="kept is 5 where scanmill has 9"))
        self.assertIn("| pcl‡ | – | 2.000 | 2.000 to 2.000 | 1 |  |", page)
        self.assertIn("- ‡ pcl: kept is 5", page)

    def test_unchecked_and_changing_results_are_said(self):
        page = self.page(entry("scanmill", [1.0], checked=0), entry("pcl", [2.0], varied=["cells"]))
        self.assertIn("- scanmill: no fact of its result was compared", page)
        self.assertIn("- pcl: differs between rounds: cells", page)

    def test_row_that_compares_nothing_does_not_say_so_of_everybody(self):
        both = results([entry("scanmill", [1.0], checked=0), entry("pcl", [2.0], checked=0)])
        self.assertEqual(table.page(both).count("no fact of its result"), 2)
        both["rows"][0]["compares"] = False
        self.assertEqual(table.page(both).count("no fact of its result"), 0)

    def test_memory_per_element_stands_below_when_the_row_asks_for_it(self):
        cloud = results([entry("scanmill", [1.0], facts={"cells": 9 * 2**20})])
        cloud["rows"][0]["peak_per"] = "cells"
        told = "- Bytes of peak memory beyond the loaded input, per element of cells: scanmill 1"
        self.assertIn(told, table.page(cloud))
        self.assertNotIn("Bytes of peak memory", self.page(entry("scanmill", [1.0], facts={"cells": 9 * 2**20})))

    def test_growth_stands_below_the_larger_row_when_both_ran(self):
        both = results([entry("scanmill", [1.0], threads=2), entry("pcl", [2.0])])
        large = results([entry("scanmill", [15.0], threads=2), entry("pcl", [20.0])])["rows"][0]
        large.update(name="large", grows_from="thin", inputs=[{"what": "a torus", "points": 10_000}])
        both["rows"].append(large)
        grown = "- Time compared with `thin`, at 10.0 times the points: "
        grown += "scanmill, 2 threads 15.0 times, pcl 10.0 times"
        self.assertIn(grown, table.page(both))
        self.assertEqual(table.page(both).count("- Time compared with"), 1)
        both["rows"] = [large]
        self.assertNotIn("compared with `thin`", table.page(both))

    def test_missing_input_fails_the_row(self):
        self.assertIn("**failed**: bunny.off is not there", self.page(failure="bunny.off is not there"))

    def test_bar_within_a_cell_does_not_end_it(self):
        self.assertIn("a \\| b", self.page(entry("pcl", [], failure="a | b")))

    def test_other_load_stands_below(self):
        self.assertIn("Other load: 0.50 cores by other processes", self.page(entry("scanmill", [1.0])))


class OutdatedTest(unittest.TestCase):
    def page(self, measured):
        small = results([entry("scanmill", [1.0])])
        small["rows"][0]["filters"] = measured
        with mock.patch.object(filters, "version", {"decimate": 4, "measure": 3}.__getitem__):
            return table.page(small)

    def test_row_shows_the_versions_that_it_measured(self):
        page = self.page({"decimate": 4, "measure": 3})
        self.assertIn("version 4 of decimate, 3 of measure", page)
        self.assertNotIn("**outdated**", page)

    def test_row_of_an_older_version_is_marked_with_both_numbers(self):
        page = self.page({"decimate": 3, "measure": 3})
        self.assertIn("## Thinning\n\n**outdated**: decimate 3, now 4\n", page)

    def test_row_of_a_removed_filter_is_marked(self):
        self.assertIn("**outdated**: collapse 1, now removed", self.page({"collapse": 1}))

    def test_version_is_read_from_the_page(self):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "edge_flip").mkdir()
            page = "# edge-flip\n\nVersion 3.\n\n- Source: Lawson 1977.\n- Version 12.\n<!-- end -->\n"
            pathlib.Path(folder, "edge_flip", "README.md").write_text(page)
            self.assertEqual(filters.version("edge-flip", folder), 12)
            with self.assertRaises(KeyError):
                filters.version("decimate", folder)

    def test_pages_of_this_tree_show_a_version(self):
        pages = list(filters.PAGES.glob("*/README.md"))
        self.assertGreater(len(pages), 30)
        for page in pages:
            self.assertGreaterEqual(filters.version(page.parent.name.replace("_", "-")), 1)


class TroubleTest(unittest.TestCase):
    def trouble(self, *entries, **more):
        return trouble(results(list(entries), **more)["rows"][0])

    def test_failing_ourselves_is_trouble_and_a_peer_failing_is_not(self):
        self.assertEqual(self.trouble(entry("scanmill", [], failure="gone"), entry("pcl", [1.0])), ["scanmill: gone"])
        self.assertEqual(self.trouble(entry("scanmill", [1.0]), entry("pcl", [], failure="gone", checked=0)), [])

    def test_missing_input_is_trouble(self):
        self.assertEqual(self.trouble(failure="no bunny"), ["no bunny"])

    def test_being_alone_with_a_result_is_trouble_and_a_peer_being_alone_is_not(self):
        wrong = entry("pcl", [1.0], unequal="kept is 5")
        self.assertEqual(self.trouble(entry("scanmill", [1.0]), wrong, entry("cgal", [1.0])), [])
        self.assertEqual(len(self.trouble(entry("scanmill", [1.0]), wrong)), 1)


class MergedTest(unittest.TestCase):
    def test_a_row_replaces_that_of_its_name_or_takes_its_place_and_has_its_own_date(self):
        old, new = results([entry("scanmill", [2.0])]), results([entry("scanmill", [1.0])])
        new.update(date="2027-08-09 10:11 UTC", revision="def")
        both = merged(old, new, ["thin"])
        self.assertEqual(both["date"], old["date"])
        self.assertEqual([row["contenders"][0]["seconds"] for row in both["rows"]], [[1.0]])
        self.assertIn("measured by itself on 2027-08-09 10:11 UTC, Scanmill def", table.page(both))
        new["rows"][0]["name"] = "first"
        both = merged(old, new, ["first", "thin", "not measured"])
        self.assertEqual([row["name"] for row in both["rows"]], ["first", "thin"])
        self.assertNotIn("measured by itself", "\n".join(table.section(both["rows"][1])))


if __name__ == "__main__":
    unittest.main()
