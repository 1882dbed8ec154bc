// SPDX-License-Identifier: GPL-3.0-or-later
/// The verdict on a part in the words of an inspection. A part that passed without a limit has a word of its own.

import type { Sheet } from "./data.ts";
import { element } from "./element.ts";

/// The worst first.
export const results = ["failed", "missing", "regressed", "doubtful", "unlimited", "passed"] as const;
export type Result = (typeof results)[number];

export const resultSymbols: Record<Result, string> = { failed: "✕", missing: "∅", regressed: "▼", doubtful: "?", unlimited: "○", passed: "✓" };
export const resultWords: Record<Result, string> = {
    failed: "Failed", missing: "Not inspected", regressed: "Regressed", doubtful: "Doubtful", unlimited: "No limit set", passed: "Passed",
};

export function resultOf(sheet: Sheet): Result {
    if (sheet.verdict === "failed" || sheet.outcome === "failed") return "failed";
    if (sheet.verdict === "missing" || sheet.inspection === null) return "missing";
    if (sheet.verdict === "regressed") return "regressed";
    if (sheet.verdict === "doubtful" || (sheet.outcome === "doubtful" && !sheet.known)) return "doubtful";
    return sheet.inspection.expected.length === 0 ? "unlimited" : "passed";
}

export function resultMark(result: Result): HTMLElement {
    return element("span", { class: `result ${result}` }, element("span", { class: "result-symbol", "aria-hidden": "true" }, resultSymbols[result]), ` ${resultWords[result]}`);
}
