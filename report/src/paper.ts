// SPDX-License-Identifier: GPL-3.0-or-later
/// Adds what only paper shows: the details of the cells that need a person, or of the cell that is open.

import { cellDetails, cellHeading, cellLine } from "./cell.ts";
import type { Cell } from "./data.ts";
import { element, replaceChildren } from "./element.ts";
import * as format from "./format.ts";
import type { Report } from "./report.ts";
import { troubles } from "./verdict.ts";

const mostCells = 40;

/// `open` is the cell of the open dialog; `redraw` draws charts for paper or for the screen.
export function preparePaper(report: Report, open: () => Cell | null, redraw: (onPaper: boolean) => void): HTMLElement {
    const root = element("section", { class: "paper-only", "aria-label": "Details for paper" });

    function before(): void {
        const one = open();
        document.documentElement.classList.add("paper");
        document.documentElement.classList.toggle("one-cell", one !== null);
        const cells = one ? [one] : report.data.cells.filter((cell) => troubles.includes(cell.verdict));
        cells.sort((a, b) => troubles.indexOf(a.verdict) - troubles.indexOf(b.verdict));
        const shown = cells.slice(0, mostCells);
        replaceChildren(root,
            !one && shown.length > 0 && element("h2", null, "Details"),
            cells.length > shown.length && element("p", null, `The first ${shown.length} of ${format.count(cells.length)} cells that are failed, missing, regressed or doubtful; open the others in the page to print them.`),
            shown.map((cell) => element("article", { class: "paper-cell" }, element("h3", { class: "paper-title" }, cellHeading(report, cell)), cellLine(cell), cellDetails(report, cell, null))));
        redraw(true);
    }

    function after(): void {
        document.documentElement.classList.remove("paper", "one-cell");
        root.replaceChildren();
        redraw(false);
    }

    addEventListener("beforeprint", before);
    addEventListener("afterprint", after);
    matchMedia("print").addEventListener("change", (event) => (event.matches ? before() : after()));
    return root;
}
