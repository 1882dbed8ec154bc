// SPDX-License-Identifier: GPL-3.0-or-later
/// Words and symbols of the verdicts. Colour is never the only difference between two of them.

import type { ReportData, Verdict } from "./data.ts";
import { element } from "./element.ts";
import { counted } from "./format.ts";

/// The worst first.
export const verdicts: readonly Verdict[] = ["failed", "missing", "regressed", "doubtful", "improved", "new", "passed"];

/// Verdicts that need a person.
export const troubles: readonly Verdict[] = ["failed", "missing", "regressed", "doubtful"];

export const symbols: Record<Verdict, string> = {
    failed: "✕",
    missing: "∅",
    regressed: "▼",
    doubtful: "?",
    improved: "▲",
    new: "+",
    passed: "✓",
};

export function badge(verdict: Verdict, text: string = verdict): HTMLElement {
    return element("span", { class: `badge ${verdict}` }, symbol(verdict), " ", text);
}

export function symbol(verdict: Verdict): HTMLElement {
    return element("span", { class: `symbol ${verdict}`, "aria-hidden": "true" }, symbols[verdict]);
}

/// The verdict of the run in one sentence.
export function sentence(data: ReportData): string {
    const cells = data.cells.length;
    const of = (verdict: Verdict) => data.counts[verdict] ?? 0;
    if (cells === 0) return "The run has no cells.";
    const than = data.accepted ? `the accepted run ${data.accepted.id}` : "an accepted run";
    switch (data.verdict) {
        case "regressed":
            return `${of("regressed")} of ${counted(cells, "cell")} ${are(of("regressed"))} worse than in ${than}.`;
        case "missing":
            return `${of("missing")} of ${counted(cells, "cell")} ${are(of("missing"))} missing, which the accepted run has.`;
        case "failed":
            return `${of("failed")} of ${counted(cells, "cell")} failed.`;
        case "doubtful":
            return `${of("doubtful")} of ${counted(cells, "cell")} ${are(of("doubtful"))} doubtful: a filter has a reason to think that the result is not the scanned surface.`;
        case "improved":
            return `${of("improved")} of ${counted(cells, "cell")} ${are(of("improved"))} better than in ${than}, and none is worse.`;
        case "new":
            return `No run is accepted yet, so ${counted(cells, "cell")} could not be compared.`;
        case "passed":
            return cells === 1 ? `The cell is as good as in ${than}.` : `All ${counted(cells, "cell")} are as good as in ${than}.`;
    }
}

function are(number: number): string {
    return number === 1 ? "is" : "are";
}
