// SPDX-License-Identifier: GPL-3.0-or-later
/// The page of a part: verdict, pictures, histogram, numbers, labels, files, doubts, and lines for a signature.

import type { Inspection, Sheet, SheetData } from "./data.ts";
import { deviationChart } from "./deviation_chart.ts";
import { element } from "./element.ts";
import type { Child } from "./element.ts";
import * as format from "./format.ts";
import { factList, labelKey, labelTable, limitSentences, partTable, toleranceText, wholeList } from "./inspection.ts";
import type { Row } from "./inspection.ts";
import { numberIn } from "./quantity.ts";
import { splitPath } from "./report.ts";
import { resultMark, resultOf } from "./sheet_result.ts";
import { shortened } from "./sheet_room.ts";
import type { Room } from "./sheet_room.ts";

export interface Numbered {
    sheet: Sheet;
    /// From 1 on, in the order of the first page.
    number: number;
}

/// Columns that a table of parts keeps longest if it is wider than the paper.
const importance = ["in-tolerance", "min", "max", "mean", "rms", "above", "below", "p1", "p99", "points", "standard-deviation", "p5", "p95", "p50"];
const [longText, mostColumns] = [46, 9];
/// Longer names have smaller letters.
export const longName = 48;

export function partPage(data: SheetData, part: Numbered, count: number, room: Room): HTMLElement {
    const { sheet } = part;
    const { inspection } = sheet;
    const [folder, name] = splitPath(shortened(sheet.scan, 180));
    return element("article", { class: "sheet", id: `part-${part.number}`, "aria-labelledby": `part-${part.number}-title` },
        element("header", { class: "heading" },
            element("div", null,
                element("p", { class: "overline" }, "Inspection sheet"),
                element("h2", { id: `part-${part.number}-title`, class: sheet.scan.length > longName ? "name long" : "name" }, folder && element("span", { class: "folder" }, folder), name),
                element("p", { class: "quiet" }, shortened([sheet.workflow, sheet.variant].filter((text) => text !== "").join(", "), 180))),
            element("div", { class: "date" }, element("p", null, format.time(data.run.started)), element("p", { class: "quiet" }, `Run ${data.run.id} of ${shortened(data.batch, 60)}`))),
        verdict(sheet, room),
        inspection ? content(data, sheet, inspection, room) : pictures(data, sheet, room),
        notes("Doubts and warnings", [...sheet.doubts.map((text): Note => ["?", "Doubt", text]), ...sheet.warnings.map((text): Note => ["!", "Warning", text])], room),
        count === 1 && notes("Notes", data.notes.map((text): Note => ["", "", text]), room),
        files(sheet, room),
        element("footer", null, signature(),
            element("p", { class: "bottom" }, element("span", null, `Scanmill ${data.run.version.replace(/^Scanmill /, "")}`), element("span", null, `Part ${part.number} of ${count}`))));
}

function verdict(sheet: Sheet, room: Room): HTMLElement {
    const { inspection } = sheet;
    const result = resultOf(sheet);
    // The sentences of the limits say the same, with both numbers.
    const isSaid = inspection !== null && inspection.expected.some((limit) => !limit.met);
    const reasons = sheet.reasons.filter((reason) => !(isSaid && reason.startsWith("expected ")));
    const hasError = sheet.error !== "" && !isSaid;
    const known = sheet.known;
    return element("section", { class: `verdict ${result}`, "aria-label": "Verdict" },
        element("p", { class: "verdict-word" }, resultMark(result)),
        element("div", null,
            inspection ? limitSentences(inspection).map((sentence) => element("p", null, sentence)) : element("p", null, "No step inspected this part."),
            inspection && element("p", null, `Tolerance ${toleranceText(inspection)}; positive is outside the nominal.`),
            reasons.slice(0, room.notes).map((reason) => element("p", null, shortened(reason, room.characters))),
            reasons.length > room.notes && element("p", { class: "quiet" }, `${format.counted(reasons.length - room.notes, "more reason")}.`),
            hasError && element("pre", null, shortened(sheet.error, room.characters)),
            known && element("p", null, shortened(`Doubts acknowledged by ${known.who}, ${format.day(known.at)}: ${known.why}`, room.characters))));
}

function content(data: SheetData, sheet: Sheet, inspection: Inspection, room: Room): Child[] {
    const labels = labelTable(inspection, room.labels);
    const hasParts = inspection.rows.length > 1;
    // The table of the parts shows the other numbers of the whole nominal.
    const whole = section("Whole nominal", wholeList(inspection, hasParts ? chosenColumns(inspection) : []));
    const conditions = section("Conditions of the comparison", factList({ ...inspection, facts: inspection.facts.slice(0, room.facts) }), left(inspection.facts.length - room.facts));
    return [
        pictures(data, sheet, room),
        element("div", { class: "columns" },
            element("div", null,
                section("Histogram of the deviations", inspection.histogram ? deviationChart(inspection.histogram, inspection.unit) : element("p", { class: "quiet" }, "There is no histogram.")),
                hasParts ? conditions : whole),
            element("div", null,
                section("Largest deviations", labels ?? element("p", { class: "quiet" }, "The step labels no points."), labels && labelKey(inspection, room.labels), left(inspection.labels.length - room.labels)),
                hasParts ? whole : conditions)),
        parts(inspection, room),
    ];
}

function parts(inspection: Inspection, room: Room): HTMLElement | null {
    if (inspection.rows.length < 2) return null;
    const { rows, order } = worstRows(inspection, room.parts);
    const columns = chosenColumns(inspection);
    const leftOut = inspection.rows.length - rows.length;
    const hidden = inspection.columns.filter((_, index) => !columns.includes(index)).map((column) => column.name);
    const remarks = [
        leftOut > 0 && `${order}; ${format.counted(leftOut, "other part")} of ${inspection.rows.length - 1} ${leftOut === 1 ? "is" : "are"} left out.`,
        hidden.length > 0 && `Not shown for parts: ${hidden.join(", ")}.`,
    ].filter((remark) => remark !== false);
    return section("The nominal and its parts", partTable(inspection, rows, columns),
        remarks.length > 0 && element("p", { class: "key" }, remarks.join(" ")));
}

/// The whole nominal and its parts. If not all fit, those that deviate most.
function worstRows(inspection: Inspection, most: number): { rows: Row[]; order: string } {
    const [whole, ...others] = inspection.rows;
    if (!whole || inspection.rows.length <= most) return { rows: inspection.rows, order: "" };
    const column = inspection.columns.findIndex((one) => one.name === "in-tolerance");
    const ends = ["min", "max"].map((name) => inspection.columns.findIndex((one) => one.name === name));
    const badness = (row: Row): number => {
        const value = column >= 0 ? -numberIn(row.texts[column] ?? "") : Math.max(...ends.map((end) => Math.abs(numberIn(row.texts[end] ?? ""))));
        return Number.isNaN(value) ? -Infinity : value;
    };
    const sorted = others.map((row, index) => ({ row, index, value: badness(row) })).sort((a, b) => (a.value === b.value ? a.index - b.index : b.value - a.value));
    return {
        rows: [whole, ...sorted.slice(0, Math.max(0, most - 1)).map((one) => one.row)],
        order: column >= 0 ? "The parts with the least share in tolerance come first" : "The parts with the largest deviations come first",
    };
}

/// The columns that fit on the paper, in the order of the data.
function chosenColumns(inspection: Inspection): number[] {
    const rank = (name: string) => (importance.includes(name) ? importance.indexOf(name) : importance.length);
    return inspection.columns.map((column, index) => ({ index, rank: rank(column.name) })).sort((a, b) => a.rank - b.rank || a.index - b.index)
        .slice(0, mostColumns).map((one) => one.index).sort((a, b) => a - b);
}

function pictures(data: SheetData, sheet: Sheet, room: Room): HTMLElement {
    const shown = sheet.pictures.slice(0, 2).filter((picture) => data.images[picture.image] !== undefined);
    if (shown.length === 0) return element("p", { class: "no-pictures quiet" }, "This part has no pictures.");
    return element("div", { class: `pictures size-${room.pictures} ${shown.length > 1 ? "two" : "one"}` }, shown.map((picture) =>
        element("figure", null, element("img", { src: data.images[picture.image], alt: `${picture.caption} of ${sheet.scan}` }), element("figcaption", null, shortened(picture.caption, 120)))));
}

type Note = [symbol: string, word: string, text: string];

function notes(title: string, all: Note[], room: Room): HTMLElement | null {
    if (all.length === 0) return null;
    const shown = all.slice(0, room.notes);
    return section(title, element("ul", { class: "notes" }, shown.map(([symbol, word, text]) =>
        element("li", null, symbol && element("span", { class: "note-symbol", "aria-hidden": "true" }, symbol), word && element("strong", { class: "plain" }, `${word}: `), shortened(text, room.characters)))),
        left(all.length - shown.length));
}

function files(sheet: Sheet, room: Room): HTMLElement | null {
    if (sheet.facts.length === 0) return null;
    const shown = sheet.facts.slice(0, room.facts);
    return section("Files and versions", element("dl", { class: "files" }, shown.map(([name, text]) =>
        element("div", { class: text.length > longText ? "wide" : null }, element("dt", null, shortened(name, 60)), element("dd", null, shortened(text, room.characters))))),
        left(sheet.facts.length - shown.length));
}

function signature(): HTMLElement {
    return element("div", { class: "signature" }, ["Name", "Date", "Signature"].map((text) => element("p", null, text)));
}

/// Reports how many there was no room for.
function left(number: number): HTMLElement | null {
    return number > 0 ? element("p", { class: "key" }, `${format.count(number)} more ${number === 1 ? "is" : "are"} left out.`) : null;
}

function section(title: string, ...contents: Child[]): HTMLElement | null {
    const filled = contents.filter((child) => child);
    return filled.length > 0 ? element("section", null, element("h3", null, title), filled) : null;
}
