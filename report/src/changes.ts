// SPDX-License-Identifier: GPL-3.0-or-later
/// What changed since the accepted run, with the accepted picture beside the new one.

import type { Cell, Change } from "./data.ts";
import { element, replaceChildren } from "./element.ts";
import * as format from "./format.ts";
import { addressOf, scanName } from "./names.ts";
import { pages } from "./pages.ts";
import type { Report } from "./report.ts";
import { badge } from "./verdict.ts";

interface Group {
    cell: Cell;
    changes: Change[];
}

const effects = [
    { effect: "regression", title: "Regressions", size: 20 },
    { effect: "improvement", title: "Improvements", size: 20 },
    { effect: "listed", title: "Other changes", size: 50 },
] as const;

export function changes(report: Report): HTMLElement | null {
    const { data } = report;
    if (!data.accepted) return null;
    const parts = effects.map(({ effect, title, size }) => {
        const groups = groupByCell(report, data.changes.filter((change) => change.effect === effect));
        if (groups.length === 0) return null;
        const list = element("ol", { class: effect === "listed" ? "changes short" : "changes" });
        const shown = pages<Group>("Cells", size, (page) => {
            replaceChildren(list, page.map((group) => item(report, group, effect !== "listed" && firstEffect(report, group) === effect)));
        });
        shown.show(groups);
        const heading = element("h3", null, `${title} `, element("span", { class: "quiet" }, format.counted(groups.length, "cell")));
        if (effect !== "listed") return element("div", { class: "effect" }, heading, list, shown.bar);
        return element("details", { class: "effect" }, element("summary", null, heading), list, shown.bar);
    });

    return element(
        "section",
        { id: "changes", "aria-labelledby": "changes-title" },
        element("h2", { id: "changes-title" }, "What changed"),
        data.changes.length === 0 ? element("p", null, `Nothing differs from the accepted run ${data.accepted.id}.`) : parts,
    );
}

/// Pictures are shown once per cell: under the first effect that it has.
function firstEffect(report: Report, group: Group): string | undefined {
    return report.changesOf(group.cell)[0]?.effect;
}

/// In the order in which the cells come first.
function groupByCell(report: Report, all: Change[]): Group[] {
    const groups = new Map<number, Group>();
    for (const change of all) {
        const group = groups.get(change.cell);
        if (group) group.changes.push(change);
        else {
            const cell = report.cell(change.cell);
            if (cell) groups.set(change.cell, { cell, changes: [change] });
        }
    }
    return [...groups.values()];
}

function item(report: Report, { cell, changes }: Group, showsPictures: boolean): HTMLElement {
    const accepted = showsPictures ? report.image(cell.pictures.accepted) : undefined;
    const found = showsPictures ? report.image(cell.pictures.result) : undefined;
    return element(
        "li",
        null,
        element(
            "div",
            { class: "change-text" },
            element("h4", null,
                element("a", { href: addressOf(cell) }, scanName(cell.scan), " ", element("span", { class: "variant" }, report.title(cell))),
                " ", badge(cell.verdict)),
            cell.causes.length > 0 && element("p", { class: "cause" }, cell.causes.join("; ")),
            changeTable(changes, `Changes of ${cell.scan} ${report.title(cell)}`),
        ),
        accepted && found &&
            element(
                "div",
                { class: "pair" },
                picture(accepted, "Accepted", `Result of the accepted run: ${cell.scan}, ${report.title(cell)}`),
                picture(found, "Now", `Result of this run: ${cell.scan}, ${report.title(cell)}`),
            ),
    );
}

function picture(source: string, caption: string, alt: string): HTMLElement {
    return element("figure", null, element("img", { src: source, alt }), element("figcaption", null, caption));
}

export function changeTable(changes: Change[], label: string): HTMLElement {
    return element(
        "div",
        { class: "scroll" },
        element(
            "table",
            { class: "change-table", "aria-label": label },
            element("thead", null, element("tr", null,
                element("th", { scope: "col" }, "What"),
                ["Accepted", "Now", "Change"].map((name) => element("th", { scope: "col", class: "right" }, name)),
                element("th", { scope: "col" }, "Rule"))),
            element("tbody", null, changes.map((change) =>
                element("tr", { class: change.effect },
                    element("th", { scope: "row" }, change.what),
                    element("td", { class: "right" }, change.accepted),
                    element("td", { class: "right" }, change.found),
                    element("td", { class: "right change" }, effectSymbol(change), change.change),
                    element("td", null, change.rule)))),
        ),
    );
}

function effectSymbol(change: Change): string {
    return change.effect === "regression" ? "▼ " : change.effect === "improvement" ? "▲ " : "";
}
