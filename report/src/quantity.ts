// SPDX-License-Identifier: GPL-3.0-or-later
/// Columns of texts such as `0.18 mm`: the unit moves to the heading, and the decimal points are aligned.

import { element } from "./element.ts";

export interface Column {
    /// The unit of all texts; empty if they have none or several.
    unit: string;
    /// `pad` is what the text lacks behind its last digit, such as `.00`.
    cells: { text: string; pad: string }[];
}

const pattern = /^([-+−]?[\d,]*)(\.\d+)?(e[-+]?\d+)?(?:\s+(.*)|(%))?$/i;

/// The number in a text; NaN if it does not begin with one.
export function numberIn(text: string): number {
    return Number.parseFloat(text.replace("−", "-").replaceAll(",", ""));
}

/// A minus sign instead of the hyphen before a number.
export function withMinus(text: string): string {
    return text.replace(/^-(?=[\d.])/, "−");
}

export function columnOf(texts: string[]): Column {
    const found = texts.map((text) => pattern.exec(text));
    const filled = found.filter((_, index) => texts[index] !== "");
    const unit = filled[0]?.[4] ?? filled[0]?.[5] ?? "";
    const isNumeric = filled.every((one) => one !== null && !one[3]);
    const isShared = filled.every((one) => one !== null && (one[4] ?? one[5] ?? "") === unit);
    const digits = isNumeric && isShared ? Math.max(0, ...filled.map((one) => (one![2] ?? "").length)) : 0;
    return {
        unit: isShared ? unit : "",
        cells: texts.map((text, index) => {
            const one = found[index];
            if (text === "") return { text: "–", pad: "" };
            if (!one || !isShared) return { text: withMinus(text), pad: "" };
            const [, whole = "", fraction = "", exponent = ""] = one;
            const pad = fraction === "" && digits > 0 ? `.${"0".repeat(digits - 1)}` : "0".repeat(Math.max(0, digits - fraction.length));
            return { text: withMinus(whole + fraction + exponent), pad };
        }),
    };
}

/// A table cell of the column. The style sheet draws the pad invisibly.
export function quantityCell(cell: { text: string; pad: string }): HTMLTableCellElement {
    return element("td", { class: "right", "data-pad": cell.pad || null }, cell.text);
}
