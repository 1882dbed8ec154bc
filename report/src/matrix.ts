// SPDX-License-Identifier: GPL-3.0-or-later
/// The matrix of scans and variants, coloured by a metric.

import type { Verdict } from "./data.ts";
import { element, replaceChildren, spoken } from "./element.ts";
import * as format from "./format.ts";
import { Heat } from "./heat.ts";
import type { Scope } from "./heat.ts";
import { filtered, sorted, troublesIn } from "./matrix_order.ts";
import type { Order } from "./matrix_order.ts";
import { addressOf, scanName } from "./names.ts";
import { pages } from "./pages.ts";
import type { Report, Row } from "./report.ts";
import { symbol, verdicts } from "./verdict.ts";

const pageSize = 200;
/// More columns than this do not fit on paper beside each other.
const paperColumns = 6;

export interface Matrix {
    readonly section: HTMLElement;
    /// Adds or removes what only paper shows.
    redraw(onPaper: boolean): void;
    /// Shows the rows that have a cell with this verdict.
    choose(verdict: Verdict): void;
}

export function matrix(report: Report): Matrix {
    const { data } = report;
    let metric = data["default-metric"];
    let scope: Scope = "row";
    let order: Order = { column: null, descending: false };
    let isSorted = false;
    let onPage: Row[] = [];
    let heat = new Heat(report, metric, scope);
    const chosen = new Set<Verdict>();

    const search = element("input", { type: "search", id: "matrix-search", autocomplete: "off", oninput: () => update() });
    const metricSelect = element("select", { id: "matrix-metric", onchange: () => recolour() },
        data.metrics.map((info) => element("option", { value: info.name, selected: info.name === metric }, info.name)));
    const scopeSelect = element("select", { id: "matrix-scope", onchange: () => recolour() },
        element("option", { value: "row" }, "each scan"), element("option", { value: "all" }, "all scans"));
    const verdictButtons = verdicts
        .filter((verdict) => (data.counts[verdict] ?? 0) > 0)
        .map((verdict) => ({
            verdict,
            button: element("button", { type: "button", class: `toggle ${verdict}`, "aria-pressed": "false", onclick: () => toggle(verdict) },
                symbol(verdict), ` ${verdict} `, element("span", { class: "quiet" }, format.count(data.counts[verdict] ?? 0))),
        }));
    const clear = element("button", { type: "button", class: "link", onclick: () => reset() }, "Show all scans");
    const status = element("p", { role: "status", class: "status" });
    const legend = element("p", { class: "quiet matrix-legend" });
    const header = element("thead");
    const body = element("tbody");
    const paper = element("div", { class: "paper-only" });
    const table = element("table", { class: "matrix", "aria-label": "Scans and variants" }, header, body);
    const scroll = element("div", { class: "scroll tall", role: "region", "aria-label": "Matrix of scans and variants", tabindex: 0 }, table);
    const shown = pages<Row>("Scans", pageSize, draw, (others) => {
        const troubles = troublesIn(others);
        return troubles === "" ? "" : `On other pages: ${troubles}.`;
    });

    function recolour(): void {
        metric = metricSelect.value;
        scope = scopeSelect.value as Scope;
        heat = new Heat(report, metric, scope);
        update();
    }

    function toggle(verdict: Verdict): void {
        if (!chosen.delete(verdict)) chosen.add(verdict);
        update();
    }

    function reset(): void {
        search.value = "";
        chosen.clear();
        update();
        search.focus();
    }

    function sortBy(column: number | null): void {
        // The first click on a column shows the worst values first.
        const better = report.metric(metric)?.better ?? null;
        const initial = column !== null && better !== "larger";
        order = isSorted && order.column === column ? { column, descending: !order.descending } : { column, descending: initial };
        isSorted = true;
        update();
        header.querySelector<HTMLElement>(`[data-column="${column ?? "name"}"]`)?.focus();
    }

    function update(): void {
        for (const { verdict, button } of verdictButtons) button.setAttribute("aria-pressed", String(chosen.has(verdict)));
        const rows = filtered(report.rows, search.value, chosen);
        const hidden = new Set(report.rows);
        for (const row of rows) hidden.delete(row);
        const troubles = troublesIn([...hidden]);
        const isFiltered = rows.length < report.rows.length;
        replaceChildren(status, isFiltered && [
            `${format.counted(rows.length, "scan")} of ${format.count(report.rows.length)} shown. `,
            troubles !== "" && element("strong", null, `Hidden: ${troubles}. `),
            clear,
        ]);
        replaceChildren(legend, element("span", { class: "ramp", "aria-hidden": "true" }), " ", heat.sentence());
        drawHeader();
        shown.show(isSorted ? sorted(report, rows, metric, order) : rows);
    }

    function drawHeader(): void {
        const cell = (title: string, column: number | null) => {
            const isActive = isSorted && order.column === column;
            const direction = order.descending ? "descending" : "ascending";
            // Equal widths for the variants, as far as they fit.
            const width: Record<string, string> = column === null ? {} : { width: `${Math.min(14, 72 / report.columns.length)}%` };
            return element("th", { scope: "col", style: width, "aria-sort": isActive ? direction : "none" },
                element("button", { type: "button", class: "sort", "data-column": column ?? "name", onclick: () => sortBy(column) },
                    title, element("span", { "aria-hidden": "true", class: "arrow" }, isActive ? (order.descending ? "↓" : "↑") : "↕")));
        };
        replaceChildren(header, element("tr", null, cell("Scan", null), report.columns.map((column, index) => cell(column.title, index))));
    }

    function draw(rows: Row[]): void {
        replaceChildren(body, rows.map((row) => line(row, 0, report.columns.length)));
        if (rows.length === 0) {
            const text = report.rows.length === 0 ? "The run has no cells." : "No scan matches.";
            replaceChildren(body, element("tr", null, element("td", { colspan: report.columns.length + 1 }, text)));
        }
        onPage = rows;
    }

    function line(row: Row, from: number, to: number): HTMLElement {
        const cells: HTMLElement[] = [];
        for (let column = from; column < to; ++column) cells.push(entry(row, column));
        return element("tr", null, element("th", { scope: "row" }, scanName(row.scan)), cells);
    }

    function entry(row: Row, column: number): HTMLElement {
        const cell = row.cells[column];
        if (!cell) return element("td", { class: "empty" }, spoken("no cell on this page"));
        const reading = report.reading(cell, metric);
        const share = reading && reading.value !== null ? heat.share(row, reading) : null;
        const known = cell.verdict === "doubtful" && cell.known !== null;
        return element("td", { class: share === null ? cell.verdict : `${cell.verdict} heat`, style: share === null ? {} : { "--share": share.toFixed(3) } },
            element("a", { href: addressOf(cell), title: [cell.verdict + (known ? ", known" : ""), ...cell.reasons].join(": ") },
                symbol(cell.verdict), spoken(`${cell.verdict}: `),
                element("span", { class: "reading" }, reading?.text ?? (cell.outcome === "failed" ? "failed" : "–")),
                known && element("span", { class: "known" }, "known")));
    }

    /// Paper has no scrolling: many columns become several tables.
    function drawForPaper(onPaper: boolean): void {
        const rows = onPage;
        scroll.classList.toggle("screen-only", report.columns.length > paperColumns);
        if (!onPaper || report.columns.length <= paperColumns) return replaceChildren(paper);
        const tables: HTMLElement[] = [];
        const parts = Math.ceil(report.columns.length / paperColumns);
        for (let part = 0; part < parts; ++part) {
            const [from, to] = [part, part + 1].map((at) => Math.round((at * report.columns.length) / parts)) as [number, number];
            tables.push(element("table", { class: "matrix" },
                element("thead", null, element("tr", null, element("th", { scope: "col" }, "Scan"),
                    report.columns.slice(from, to).map((column) => element("th", { scope: "col" }, column.title)))),
                element("tbody", null, rows.map((row) => line(row, from, to)))));
        }
        replaceChildren(paper, tables);
    }

    const section = element(
        "section",
        { id: "matrix", "aria-labelledby": "matrix-title" },
        element("h2", { id: "matrix-title" }, "Matrix"),
        element(
            "div",
            { class: "controls" },
            element("label", null, "Metric ", metricSelect),
            element("label", null, "Colours within ", scopeSelect),
            element("label", null, "Scan ", search),
            verdictButtons.length > 1 && element("div", { class: "toggles", role: "group", "aria-label": "Only scans with a cell that is" }, verdictButtons.map(({ button }) => button)),
        ),
        status,
        legend,
        shown.bar,
        scroll,
        paper,
    );
    update();

    return {
        section,
        redraw: drawForPaper,
        choose(verdict) {
            search.value = "";
            chosen.clear();
            chosen.add(verdict);
            update();
            section.scrollIntoView();
            verdictButtons.find((one) => one.verdict === verdict)?.button.focus({ preventScroll: true });
        },
    };
}
