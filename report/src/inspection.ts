// SPDX-License-Identifier: GPL-3.0-or-later
/// What the inspection of a part found: limits, numbers of the nominal and its parts, labels, facts.

import type { Inspection, Limit } from "./data.ts";
import { deviationChart } from "./deviation_chart.ts";
import { element, spoken } from "./element.ts";
import type { Child } from "./element.ts";
import * as format from "./format.ts";
import { columnOf, quantityCell, withMinus } from "./quantity.ts";

export type Row = Inspection["rows"][number];

export function toleranceText(inspection: Inspection): string {
    const [low, high] = inspection.tolerance;
    return `${format.signed(low)} to ${format.signed(high)}${inspection.unit && ` ${inspection.unit}`}`;
}

/// The text of a metric of the whole nominal. Undefined if it is not in the table.
export function found(inspection: Inspection, metric: string): string | undefined {
    return inspection.rows[0]?.texts[inspection.columns.findIndex((one) => one.name === metric)] || undefined;
}

/// No line break between a number and its unit.
function unbroken(text: string): string {
    return text.replace(/(\d) (?=[^\d\s])(?!to )/g, "$1\u00a0");
}

export function nameOf(metric: string): string {
    const [name = "", number] = metric.split("@");
    return name.replaceAll("-", " ") + (number === undefined ? "" : ` of part ${number}`);
}

/// `in tolerance at least 99 %`
export function limitText(limit: Limit): string {
    return `${nameOf(limit.name)} ${unbroken(withMinus(limit.limit))}`;
}

/// A sentence per limit: `In tolerance 82.02 %; expected: at least 99 %.` With several, a symbol marks those that are not met.
export function limitSentences(inspection: Inspection): string[] {
    if (inspection.expected.length === 0) return ["The workflow sets no limit for this part."];
    const marks = inspection.expected.length > 1;
    return inspection.expected.map((limit) => {
        const name = nameOf(limit.name);
        const value = limit.value === "" ? "" : ` ${unbroken(withMinus(limit.value))}`;
        return `${marks ? (limit.met ? "✓ " : "✕ ") : ""}${name.charAt(0).toUpperCase()}${name.slice(1)}${value}; expected: ${unbroken(withMinus(limit.limit))}.`;
    });
}

/// A row per part and a column per metric. `columns` are the numbers of the columns that are shown.
export function partTable(inspection: Inspection, rows: Row[], columns: number[] = inspection.columns.map((_, index) => index)): HTMLElement {
    const made = columns.map((column) => columnOf(rows.map((row) => row.texts[column] ?? "")));
    return scrolled("Numbers of the nominal and its parts", element("table", { class: "parts", "aria-label": "Numbers of the nominal and its parts" },
        element("thead", null, element("tr", null, element("th", { scope: "col" }, "Part"), columns.map((column, index) =>
            element("th", { scope: "col", class: "right" }, metricName(inspection.columns[column]!), unitOf(made[index]!.unit))))),
        element("tbody", null, rows.map((row, at) => element("tr", { class: row === inspection.rows[0] ? "whole" : null },
            element("th", { scope: "row" }, row.part), made.map((column) => quantityCell(column.cells[at]!)))))));
}

/// The points that deviate most. A symbol marks those outside the tolerance.
export function labelTable(inspection: Inspection, most = inspection.labels.length): HTMLElement | null {
    if (inspection.labels.length === 0) return null;
    const labels = inspection.labels.slice(0, most);
    const deviations = columnOf(labels.map((label) => (label.value > 0 ? label.deviation.replace(/^(?=[\d.])/, "+") : label.deviation)));
    const positions = [0, 1, 2].map((axis) => columnOf(labels.map((label) => label.position[axis] ?? "")));
    const [low, high] = inspection.tolerance;
    return scrolled("Largest deviations", element("table", { class: "labels", "aria-label": "Largest deviations" },
        element("thead", null, element("tr", null, element("th", { scope: "col", class: "right" }, "No."),
            element("th", { scope: "col", class: "right deviation" }, "deviation", unitOf(deviations.unit)), element("th", { scope: "col" }, spoken("Tolerance")),
            ["x", "y", "z"].map((axis, index) => element("th", { scope: "col", class: "right" }, axis, unitOf(positions[index]!.unit))))),
        element("tbody", null, labels.map((label, index) => element("tr", null,
            element("td", { class: "right" }, index + 1), quantityCell(deviations.cells[index]!), element("td", { class: "mark" }, mark(label.value, low, high)),
            positions.map((column) => quantityCell(column.cells[index]!)))))));
}

/// Explains the symbols of the labels that are shown.
export function labelKey(inspection: Inspection, most = inspection.labels.length): HTMLElement | null {
    const [low, high] = inspection.tolerance;
    const labels = inspection.labels.slice(0, most);
    const texts = [labels.some((label) => label.value > high) && "▲ above the tolerance", labels.some((label) => label.value < low) && "▼ below the tolerance"].filter((text) => text !== false);
    return labels.length === 0 ? null : element("p", { class: "key" }, texts.length > 0 ? texts.join(", ") : "All are within the tolerance.");
}

export function factList(inspection: Inspection): HTMLElement | null {
    if (inspection.facts.length === 0) return null;
    return element("dl", { class: "numbers" }, inspection.facts.map((fact) =>
        element("div", null, element("dt", null, metricName(fact)), element("dd", null, withMinus(fact.text)))));
}

/// The numbers of the whole nominal as pairs of name and text, without the columns that are shown elsewhere.
export function wholeList(inspection: Inspection, elsewhere: number[]): HTMLElement | null {
    const columns = inspection.columns.map((column, index) => ({ column, index })).filter(({ index }) => !elsewhere.includes(index));
    const texts = inspection.rows[0]?.texts ?? [];
    if (texts.length === 0 || columns.length === 0) return null;
    return element("dl", { class: "numbers" }, columns.map(({ column, index }) =>
        element("div", null, element("dt", null, metricName(column)), element("dd", null, withMinus(texts[index] || "–")))));
}

/// The inspection in the details of a cell.
export function inspectionDetails(inspection: Inspection): Child[] {
    const chart = inspection.histogram !== null && deviationChart(inspection.histogram, inspection.unit);
    const labels = labelTable(inspection);
    return [
        element("div", { class: "inspection" },
            element("p", null, "Tolerance ", element("strong", { class: "plain" }, toleranceText(inspection)), ". ", limitSentences(inspection).join(" ")),
            inspection.rows.length > 0 && partTable(inspection, inspection.rows),
            element("div", { class: "inspection-columns" },
                chart,
                labels && element("div", null, element("h4", null, "Largest deviations"), labels, labelKey(inspection)),
                inspection.facts.length > 0 && element("div", null, element("h4", null, "Other numbers"), factList(inspection)))),
    ];
}

function mark(value: number, low: number, high: number): Child {
    if (value > high) return [element("span", { "aria-hidden": "true" }, "▲"), spoken("above")];
    if (value < low) return [element("span", { "aria-hidden": "true" }, "▼"), spoken("below")];
    return spoken("within");
}

function metricName(metric: { name: string; help: string }): HTMLElement {
    return metric.help ? element("abbr", { title: metric.help }, metric.name) : element("span", null, metric.name);
}

function unitOf(unit: string): Child {
    return unit && [" ", element("span", { class: "unit" }, unit)];
}

function scrolled(title: string, table: HTMLElement): HTMLElement {
    return element("div", { class: "scroll", role: "region", "aria-label": title, tabindex: 0 }, table);
}
