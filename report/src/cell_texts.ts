// SPDX-License-Identifier: GPL-3.0-or-later
/// The texts and tables of a cell: reasons, doubts, error, log, values, outputs and the command that reproduces it.

import type { Cell, Change, Inspection, Value } from "./data.ts";
import { element } from "./element.ts";
import * as format from "./format.ts";
import type { Report } from "./report.ts";

export function findings(cell: Cell): HTMLElement | null {
    const known = cell.known && element("p", { class: "known-note" },
        element("strong", null, "Known. "), `Acknowledged by ${cell.known.who}, ${format.day(cell.known.at)}: ${cell.known.why}`);
    // The doubts are the reasons of a doubtful cell, and the error begins with that of a failed one.
    const reasons = cell.reasons.filter((reason) => !cell.doubts.includes(reason) && !cell.error.startsWith(reason));
    const parts = [
        list("Reasons", reasons),
        list("Causes", cell.causes),
        cell.error !== "" && element("div", { class: "finding failed" }, element("h3", null, "Error"), element("pre", null, cell.error)),
        list("Doubts", cell.doubts, "doubtful", known),
        list("Warnings", cell.warnings),
    ].filter((part) => part);
    return parts.length > 0 ? element("div", { class: "findings" }, parts) : null;
}

function list(title: string, texts: string[], kind: string | null = null, more: HTMLElement | null = null): HTMLElement | null {
    if (texts.length === 0) return null;
    return element("div", { class: `finding ${kind ?? ""}` }, element("h3", null, title), element("ul", null, texts.map((text) => element("li", null, text))), more);
}

/// A row per value and, beside it, the accepted one. Numbered values, such as `label@2`, are folded unless they changed; so
/// are the values that the section of the inspection shows.
export function values(report: Report, cell: Cell): HTMLElement[] {
    const changes = new Map(report.changesOf(cell).map((change) => [change.what, change]));
    const isFolded = (value: Value) => !changes.has(value.name) && (isNumbered(value) || isInspected(value, cell.inspection));
    const shown = cell.values.filter((value) => !isFolded(value));
    const folded = cell.values.filter(isFolded);
    return [
        ...(shown.length > 0 ? [valueTable("Values", shown, changes)] : []),
        ...(folded.length > 0 ? [element("details", { class: "numbered" },
            element("summary", null, format.counted(folded.length, "numbered value")), valueTable("Numbered values", folded, changes))] : []),
    ];
}

function isNumbered(value: Value): boolean {
    return /@\d+$/.test(value.name);
}

function isInspected(value: Value, inspection: Inspection | null): boolean {
    return value.source === inspection?.step && /^(histogram|label|label-[xyz])$/.test(value.name);
}

function valueTable(title: string, values: Value[], changes: Map<string, Change>): HTMLElement {
    const hasAccepted = values.some((value) => value.accepted !== null);
    let source = "";
    const rows = values.map((value) => {
        const isNew = value.source !== source;
        source = value.source;
        const change = changes.get(value.name);
        const differs = value.accepted !== null && value.accepted !== value.text;
        return element("tr", { class: change && change.accepted === value.accepted ? change.effect : null },
            element("td", { class: isNew ? "source" : "source again" }, value.source),
            element("th", { scope: "row" }, value.name),
            hasAccepted && element("td", { class: "right quiet" }, value.accepted ?? "–"),
            element("td", { class: differs ? "right differs" : "right" }, value.text));
    });
    return element("div", { class: "scroll", role: "region", "aria-label": title, tabindex: 0 },
        element("table", { class: "values", "aria-label": title },
            element("thead", null, element("tr", null,
                element("th", { scope: "col" }, "Source"), element("th", { scope: "col" }, "Name"),
                hasAccepted && element("th", { scope: "col", class: "right" }, "Accepted"),
                element("th", { scope: "col", class: "right" }, "Now"))),
            element("tbody", null, rows)));
}

export function outputs(cell: Cell): HTMLElement | null {
    if (cell.outputs.length === 0) return null;
    return element("div", { class: "scroll", role: "region", "aria-label": "Output files", tabindex: 0 },
        element("table", { class: "outputs", "aria-label": "Output files" },
            element("thead", null, element("tr", null,
                element("th", { scope: "col" }, "File"), element("th", { scope: "col", class: "right" }, "Size"), element("th", { scope: "col" }, "SHA-256"))),
            element("tbody", null, cell.outputs.map((output) =>
                element("tr", null, element("th", { scope: "row" }, output.file), element("td", { class: "right" }, format.bytes(output.bytes)),
                    element("td", null, element("code", { class: "hash" }, output.sha256)))))));
}

export function log(cell: Cell): HTMLElement | null {
    if (cell.log === "") return null;
    const text = element("pre", { class: "log", tabindex: 0, role: "region", "aria-label": "End of the log" }, cell.log);
    // The end is what explains a failure.
    requestAnimationFrame(() => (text.scrollTop = text.scrollHeight));
    return text;
}

export function command(cell: Cell): HTMLElement | null {
    if (cell.command === "") return null;
    const status = element("span", { role: "status", class: "quiet" });
    const code = element("code", null, cell.command);
    const copy = element("button", { type: "button", class: "screen-only", onclick: () => void copyText() }, "Copy");

    async function copyText(): Promise<void> {
        try {
            await navigator.clipboard.writeText(cell.command);
            status.textContent = "Copied.";
        } catch {
            // Without access to the clipboard the text is selected, ready for the keyboard.
            getSelection()?.selectAllChildren(code);
            status.textContent = "Selected; press Ctrl+C.";
        }
    }
    return element("div", { class: "command" }, element("pre", { tabindex: 0, role: "region", "aria-label": "Command" }, code), copy, status);
}
