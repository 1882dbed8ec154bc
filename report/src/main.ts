// SPDX-License-Identifier: GPL-3.0-or-later
/// Builds the page from its data.

import { cellDialog } from "./cell_dialog.ts";
import { changes } from "./changes.ts";
import type { ReportData } from "./data.ts";
import { element } from "./element.ts";
import { matrix } from "./matrix.ts";
import { preparePaper } from "./paper.ts";
import { Report } from "./report.ts";
import { rules } from "./rules.ts";
import { summary } from "./summary.ts";
import { trends } from "./trends.ts";
import { symbols } from "./verdict.ts";

const data = JSON.parse(document.getElementById("data")?.textContent ?? "null") as ReportData | null;
if (data) build(new Report(data));
else document.body.append(element("main", null, element("h1", null, "Scanmill report"),
    element("p", null, "This page has no data. The command ", element("code", null, "scanmill report DIR --html FILE"), " writes a page with data.")));

function build(report: Report): void {
    document.title = `${symbols[report.data.verdict]} ${report.data.batch}: ${report.data.verdict}`;
    const table = matrix(report);
    const chart = trends(report);
    const dialog = cellDialog(report, forgetCell);
    const sections = [changes(report), rules(report), table.section, chart?.section ?? null].filter((section) => section !== null);

    function redraw(onPaper: boolean): void {
        table.redraw(onPaper);
        chart?.redraw(onPaper);
    }

    function forgetCell(): void {
        if (/^#cell-/.test(location.hash)) history.replaceState(null, "", "#");
    }

    function follow(): void {
        const [, kind, id] = /^#(cell|trend)-(\d+)$/.exec(location.hash) ?? [];
        const cell = id === undefined ? undefined : report.cell(Number(id));
        if (kind === "cell" && cell) return dialog.open(cell);
        dialog.close();
        if (kind === "trend" && cell) chart?.choose(cell.scan);
    }

    document.body.append(
        element("a", { class: "skip", href: "#summary" }, "Skip the navigation"),
        element("header", { class: "top" },
            element("nav", { "aria-label": "Sections" },
                element("a", { href: "#summary" }, "Summary"),
                sections.map((section) => element("a", { href: `#${section.id}` }, section.querySelector("h2")?.textContent)))),
        element("main", null, summary(report, table.choose), sections, preparePaper(report, dialog.shown, redraw)),
        element("footer", { class: "bottom" }, element("p", { class: "quiet" }, `Made by Scanmill from the records in ${report.data.folder}.`)),
        dialog.root);
    addEventListener("hashchange", follow);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => chart?.redraw(false));
    follow();
}
