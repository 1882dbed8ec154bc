// SPDX-License-Identifier: GPL-3.0-or-later
/// The table of the gate's rules: the median change of every metric by variant.

import { element } from "./element.ts";
import * as format from "./format.ts";
import type { Report } from "./report.ts";

export function rules(report: Report): HTMLElement | null {
    if (report.data.rules.length === 0) return null;
    const rows = report.data.rules.map((rule) =>
        element(
            "tr",
            { class: rule.regressed > 0 ? "bad" : null },
            element("th", { scope: "row" }, rule.metric),
            element("td", null, rule.rule),
            element("td", null, rule.variant),
            element("td", { class: "right" }, format.count(rule.cells)),
            element("td", { class: "right" }, rule.median),
            element("td", { class: "right" }, rule["median-change"]),
            element("td", { class: "right" }, rule.regressed > 0 ? element("strong", null, `▼ ${format.count(rule.regressed)}`) : "0"),
        ),
    );
    return element(
        "section",
        { id: "rules", "aria-labelledby": "rules-title" },
        element("h2", { id: "rules-title" }, "By rule and variant"),
        element(
            "div",
            { class: "scroll", role: "region", "aria-labelledby": "rules-title", tabindex: 0 },
            element(
                "table",
                { class: "rules" },
                element("thead", null, element("tr", null,
                    ["Metric", "Rule", "Variant"].map((name) => element("th", { scope: "col" }, name)),
                    ["Cells", "Median", "Median change", "Regressed"].map((name) => element("th", { scope: "col", class: "right" }, name)))),
                element("tbody", null, rows),
            ),
        ),
    );
}
