// SPDX-License-Identifier: GPL-3.0-or-later
/// The first screen: the verdict in words, the counts, the two runs and what is known about them.

import type { Run, Verdict } from "./data.ts";
import { element } from "./element.ts";
import * as format from "./format.ts";
import type { Report } from "./report.ts";
import { badge, sentence, symbol, troubles, verdicts } from "./verdict.ts";

/// `choose` shows the cells with a verdict in the matrix.
export function summary(report: Report, choose: (verdict: Verdict) => void): HTMLElement {
    const { data } = report;
    return element(
        "section",
        { id: "summary", "aria-labelledby": "summary-title", class: "summary" },
        element("p", { class: "overline" }, "Scanmill report"),
        element("h1", { id: "summary-title" }, data.batch, " ", badge(data.verdict)),
        element("p", { class: "sentence" }, sentence(data)),
        element(
            "ul",
            { class: "counts", "aria-label": "Cells by verdict" },
            verdicts.map((verdict) => tile(verdict, data.counts[verdict] ?? 0, choose)),
        ),
        element(
            "div",
            { class: "runs" },
            runCard(`Run ${data.run.id}`, data.run),
            data.accepted
                ? runCard(`Accepted run ${data.accepted.id}`, data.accepted, acceptanceOf(report))
                : element("div", { class: "card" }, element("h2", null, "Accepted run"), element("p", null, "None. The first one is chosen with ", element("code", null, "scanmill report --accept"), ".")),
        ),
        data.facts.length > 0 &&
            element(
                "dl",
                { class: "facts" },
                data.facts.map(([name, text]) => element("div", null, element("dt", null, name), element("dd", null, text))),
            ),
        data.notes.length > 0 && element("ul", { class: "notes" }, data.notes.map((note) => element("li", null, note))),
    );
}

function tile(verdict: Verdict, number: number, choose: (verdict: Verdict) => void): HTMLElement {
    if (number === 0) return element("li", { class: "none" }, tileText(verdict, number));
    const trouble = troubles.includes(verdict);
    return element(
        "li",
        null,
        element(
            "button",
            { type: "button", class: trouble ? `tile ${verdict} trouble` : `tile ${verdict}`, title: `Show the ${verdict} cells in the matrix`, onclick: () => choose(verdict) },
            tileText(verdict, number),
        ),
    );
}

function tileText(verdict: Verdict, number: number): HTMLElement[] {
    return [
        element("span", { class: "number" }, format.count(number)),
        element("span", { class: "word" }, symbol(verdict), " ", verdict),
    ];
}

function runCard(title: string, run: Run, ...more: HTMLElement[]): HTMLElement {
    return element(
        "div",
        { class: "card" },
        element("h2", null, title),
        element("p", null, format.time(run.started), ", ", format.seconds(run.seconds)),
        element("p", null, run.version, " on ", run.machine),
        element("p", { class: "quiet" }, `${format.counted(run.jobs, "job")}, ${format.counted(run.threads, "thread")}`),
        more,
    );
}

function acceptanceOf(report: Report): HTMLElement {
    const by = report.data.acceptance;
    if (!by) return element("p", { class: "quiet" }, "The last run before this one; none was accepted.");
    return element("p", { class: "quiet" }, `Accepted by ${by.who}, ${format.day(by.at)}: ${by.why}`);
}
