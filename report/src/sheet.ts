// SPDX-License-Identifier: GPL-3.0-or-later
/// Builds the inspection sheets from their data: a first page for several parts, and a page per part.

import type { SheetData } from "./data.ts";
import { element } from "./element.ts";
import { cover } from "./sheet_cover.ts";
import { partPage } from "./sheet_part.ts";
import type { Numbered } from "./sheet_part.ts";
import { resultOf, results, resultSymbols, resultWords } from "./sheet_result.ts";
import { firstFit, roomsOf } from "./sheet_room.ts";

/// Height of a page of a part in pixels of CSS: A4 without the margins, and without the little by which the layouts of screen and
/// paper differ.
const paperHeight = ((297 - 2 * 14 - 3) * 96) / 25.4;

// The sheet looks like paper, whatever colours the reader prefers.
document.documentElement.classList.add("paper");
const data = JSON.parse(document.getElementById("data")?.textContent ?? "null") as SheetData | null;
if (data) build(data);
else document.body.append(element("main", { class: "empty" }, element("h1", null, "Inspection sheet"), element("p", null, "This page has no data.")));

function build(data: SheetData): void {
    const parts = numbered(data);
    const isOne = parts.length === 1;
    const worst = results.find((result) => parts.some(({ sheet }) => resultOf(sheet) === result)) ?? "missing";
    document.title = `${resultSymbols[worst]} ${data.batch}: inspection, ${isOne ? resultWords[worst].toLowerCase() : `${parts.length} parts`}`;
    document.body.append(
        element("header", { class: "topbar" },
            element(parts.length > 1 ? "p" : "h1", null, `Inspection of ${data.batch}`),
            parts.length > 1 && element("a", { href: "#parts" }, "All parts"),
            element("button", { type: "button", onclick: () => print() }, "Print")),
        element("main", null,
            parts.length > 1 && cover(data, parts),
            parts.length === 0 && element("article", { class: "sheet" }, element("p", null, "The run has no parts."), data.notes.map((note) => element("p", null, note))),
            pages(data, parts, parts.length)));
    // The browser looked for the address before its element was made.
    if (location.hash) document.getElementById(location.hash.slice(1))?.scrollIntoView();
}

/// Those that fail first, numbered from 1 on.
function numbered(data: SheetData): Numbered[] {
    const order = data.sheets.map((sheet, index) => ({ sheet, index, rank: results.indexOf(resultOf(sheet)) }));
    order.sort((a, b) => a.rank - b.rank || a.index - b.index);
    return order.map(({ sheet }, index) => ({ sheet, number: index + 1 }));
}

/// The pages of the parts, each as full as one sheet of paper allows.
function pages(data: SheetData, parts: Numbered[], count: number): HTMLElement[] {
    const ruler = element("div", { class: "ruler", "aria-hidden": "true" });
    document.body.append(ruler);
    let guess = 0;
    const made = parts.map((part) => {
        const rooms = roomsOf(data, part.sheet);
        const page = (index: number) => partPage(data, part, count, rooms[index]!);
        guess = firstFit(rooms.length, (index) => {
            ruler.replaceChildren(page(index));
            return ruler.getBoundingClientRect().height <= paperHeight;
        }, guess);
        return page(guess);
    });
    ruler.remove();
    return made;
}
