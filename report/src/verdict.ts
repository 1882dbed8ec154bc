// SPDX-License-Identifier: GPL-3.0-or-later
/// Words and symbols of the verdicts. Colour is never the only difference between two of them.

import type { ReportData, Verdict } from "./data.ts";
import { element } from "./element.ts";
import { count } from "./format.ts";

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

/// The verdict of the run in words. The other cells that need a person are counted in a second sentence.
export function sentence(data: ReportData): string {
    const others = troubles
        .filter((verdict) => verdict !== data.verdict && (data.counts[verdict] ?? 0) > 0)
        .map((verdict) => `${count(data.counts[verdict] ?? 0)} ${verdict}`);
    return verdictSentence(data) + (others.length > 0 ? ` Also ${others.join(", ")}.` : "");
}

function verdictSentence(data: ReportData): string {
    const cells = verdicts.reduce((sum, verdict) => sum + (data.counts[verdict] ?? 0), 0);
    if (cells === 0) return "The run has no cells.";
    const number = data.counts[data.verdict] ?? 0;
    const some = cells === 1 ? "The cell" : `${count(number)} of ${count(cells)} cells`;
    const are = number === 1 ? "is" : "are";
    const than = data.accepted ? `the accepted run ${data.accepted.id}` : "an accepted run";
    switch (data.verdict) {
        case "regressed":
            return `${some} ${are} worse than in ${than}.`;
        case "missing":
            return `${some} ${are} missing, which ${than} has.`;
        case "failed":
            return `${some} failed.`;
        case "doubtful":
            return `${some} ${are} doubtful: a filter has a reason to think that the result is not the scanned surface.`;
        case "improved":
            return `${some} ${are} better than in ${than}, and none is worse.`;
        case "new":
            return `No run is accepted yet, so ${cells === 1 ? "the cell" : `${count(cells)} cells`} could not be compared.`;
        case "passed":
            return cells === 1 ? `The cell is as good as in ${than}.` : `All ${count(cells)} cells are as good as in ${than}.`;
    }
}
