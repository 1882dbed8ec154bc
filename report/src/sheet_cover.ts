// SPDX-License-Identifier: GPL-3.0-or-later
/// The first page of several parts: how many passed, and a table of the parts, those that fail first.

import type { Sheet, SheetData } from "./data.ts";
import { element } from "./element.ts";
import type { Child } from "./element.ts";
import * as format from "./format.ts";
import { found, limitText } from "./inspection.ts";
import { scanName } from "./names.ts";
import { columnOf, quantityCell } from "./quantity.ts";
import type { Column } from "./quantity.ts";
import { resultMark, resultOf, results, resultSymbols, resultWords } from "./sheet_result.ts";
import { longName } from "./sheet_part.ts";
import type { Numbered } from "./sheet_part.ts";

const metrics = ["in-tolerance", "min", "max"];
const headings = ["In tolerance", "Lowest", "Highest"];

export function cover(data: SheetData, parts: Numbered[]): HTMLElement {
    const columns = metrics.map((metric) => columnOf(parts.map(({ sheet }) => (sheet.inspection && found(sheet.inspection, metric)) ?? "")));
    const severalWorkflows = new Set(parts.map(({ sheet }) => sheet.workflow)).size > 1;
    const severalVariants = new Set(parts.map(({ sheet }) => sheet.variant)).size > 1;
    return element("article", { class: "sheet cover", id: "parts", "aria-labelledby": "parts-title" },
        element("header", { class: "heading" },
            element("div", null, element("p", { class: "overline" }, "Inspection"), element("h1", { id: "parts-title", class: data.batch.length > longName ? "name long" : "name" }, data.batch)),
            element("div", { class: "date" }, element("p", null, format.time(data.run.started)), element("p", { class: "quiet" }, `Run ${data.run.id}`))),
        element("p", { class: "sentence" }, sentence(parts)),
        element("ul", { class: "counts", "aria-label": "Parts by verdict" }, results.map((result) => {
            const number = parts.filter(({ sheet }) => resultOf(sheet) === result).length;
            return number > 0 && element("li", { class: `result ${result}` },
                element("span", { class: "result-symbol", "aria-hidden": "true" }, resultSymbols[result]), ` ${format.count(number)} ${resultWords[result].toLowerCase()}`);
        })),
        element("div", { class: "scroll", role: "region", "aria-label": "Parts", tabindex: 0 },
            element("table", { class: "cover-parts", "aria-label": "Parts" },
                element("thead", null, element("tr", null,
                    element("th", { scope: "col", class: "right" }, "No."), element("th", { scope: "col" }, "Part"), severalVariants && element("th", { scope: "col" }, "Variant"),
                    element("th", { scope: "col" }, "Verdict"),
                    columns.map((column, index) => element("th", { scope: "col", class: "right" }, headings[index], column.unit && [" ", element("span", { class: "unit" }, column.unit)])),
                    element("th", { scope: "col" }, "Expected"))),
                element("tbody", null, parts.map((part, index) => row(part, index, columns, severalWorkflows, severalVariants))))),
        data.notes.length > 0 && element("ul", { class: "notes" }, data.notes.map((note) => element("li", null, note))),
        element("p", { class: "bottom" }, element("span", null, `Scanmill ${data.run.version.replace(/^Scanmill /, "")} on ${data.run.machine}`), element("span", null, data.folder)));
}

function row({ sheet, number }: Numbered, index: number, columns: Column[], withWorkflow: boolean, withVariant: boolean): HTMLElement {
    const { inspection } = sheet;
    const name = [scanName(sheet.scan), withWorkflow && element("span", { class: "quiet" }, ` ${sheet.workflow}`)];
    return element("tr", null,
        element("td", { class: "right" }, number),
        element("th", { scope: "row" }, inspection ? element("a", { href: `#part-${number}` }, name) : name),
        withVariant && element("td", { class: "variant-name" }, sheet.variant),
        element("td", { class: "word" }, resultMark(resultOf(sheet))),
        inspection
            ? [columns.map((column) => quantityCell(column.cells[index]!)), element("td", { class: "expected" }, expectations(sheet))]
            : element("td", { colspan: columns.length + 1, class: "why" }, why(sheet)));
}

function expectations(sheet: Sheet): Child {
    const expected = sheet.inspection?.expected ?? [];
    return expected.length === 0 ? element("span", { class: "quiet" }, "no limit") : expected.map(limitText).join("; ");
}

function why(sheet: Sheet): Child {
    if (sheet.error !== "") return element("pre", null, sheet.error);
    return sheet.reasons.length > 0 ? sheet.reasons.join("; ") : "No step inspected this part.";
}

function sentence(parts: Numbered[]): string {
    const all = format.count(parts.length);
    const failed = parts.filter(({ sheet }) => resultOf(sheet) === "failed").length;
    const passed = parts.filter(({ sheet }) => resultOf(sheet) === "passed").length;
    const unlimited = parts.filter(({ sheet }) => resultOf(sheet) === "unlimited").length;
    const end = unlimited > 0 ? ` For ${format.counted(unlimited, "part")} the workflow sets no limit.` : "";
    if (failed > 0) return `${format.count(failed)} of ${all} parts failed, ${format.count(passed)} passed.${end}`;
    return passed === parts.length ? `All ${all} parts passed.` : `${format.count(passed)} of ${all} parts passed, none failed.${end}`;
}
