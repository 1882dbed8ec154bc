// SPDX-License-Identifier: GPL-3.0-or-later
/// The steps of a cell, each with a bar that begins where the step before it ended.

import type { Cell, Step } from "./data.ts";
import { element } from "./element.ts";
import * as format from "./format.ts";

export function waterfall(cell: Cell): HTMLElement | null {
    if (cell.steps.length === 0) return null;
    const total = cell.steps.reduce((sum, step) => sum + step.seconds, 0) || 1;
    const most = Math.max(...cell.steps.map((step) => step.memory)) || 1;
    let before = 0;
    const rows = cell.steps.map((step) => {
        const start = (before / total) * 100;
        before += step.seconds;
        return row(step, start, (step.seconds / total) * 100, step.memory / most);
    });
    const right = ["Seconds", "Processor", "Memory"].map((name) => element("th", { scope: "col", class: "right" }, name));
    return element("div", { class: "scroll", role: "region", "aria-label": "Steps", tabindex: 0 },
        element("table", { class: "waterfall", "aria-label": "Steps" },
            element("thead", null, element("tr", null,
                element("th", { scope: "col" }, "Step"), element("th", { scope: "col", class: "chart" }, "Time"), right,
                element("th", { scope: "col" }, "Origin"))),
            element("tbody", null, rows)));
}

function row(step: Step, start: number, width: number, memory: number): HTMLElement {
    const failed = step.outcome === "failed";
    return element("tr", { class: failed ? "bad" : null },
        element("th", { scope: "row" },
            step.label, " ", element("span", { class: "quiet" }, `${step.filter === step.label ? "" : `${step.filter} `}v${step.version}`),
            step.outcome !== "ok" && element("span", { class: failed ? "badge failed" : "badge doubtful" }, step.outcome),
            step.parameters.length > 0 && element("ul", { class: "parameters" }, step.parameters.map(([name, text]) =>
                element("li", null, element("span", { class: "quiet" }, name), " ", text)))),
        element("td", { class: "chart" },
            element("div", { class: step.origin === "ran" ? "bar" : "bar cached", style: { "margin-left": `${start}%`, width: `max(2px, ${width}%)` } })),
        element("td", { class: "right" }, format.seconds(step.seconds)),
        element("td", { class: "right" }, format.seconds(step["cpu-seconds"])),
        element("td", { class: "right" }, format.bytes(step.memory), element("div", { class: "memory", style: { width: `${memory * 100}%` } })),
        element("td", null, step.origin));
}
