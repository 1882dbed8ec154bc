// SPDX-License-Identifier: GPL-3.0-or-later
/// The histogram of a cell's deviations with its tolerance band.

import { colourOf, css, scaleOf } from "./colour_scale.ts";
import type { Histogram } from "./data.ts";
import { element, svgElement } from "./element.ts";
import * as format from "./format.ts";

const height = 60;

/// `top` is the share at the upper edge, the same for all histograms that are compared.
export function histogram(data: Histogram, unit: string, title: string, top: number, isCurrent: boolean): HTMLElement {
    const width = 200;
    const bin = width / data.shares.length;
    const at = (value: number) => ((value - data.low) / (data.high - data.low || 1)) * width;
    const centre = (index: number) => data.low + ((index + 0.5) / data.shares.length) * (data.high - data.low);
    const clamp = (value: number) => Math.min(Math.max(at(value), 0), width);
    const band = data.tolerance && svgElement("rect", { class: "band", x: clamp(data.tolerance[0]), y: 0, width: clamp(data.tolerance[1]) - clamp(data.tolerance[0]), height });
    const bars = data.shares.map((share, index) => {
        const size = top > 0 ? (share / top) * (height - 2) : 0;
        return svgElement("rect", { x: index * bin + bin * 0.06, y: height - size, width: bin * 0.88, height: size, class: "bar", fill: css(colourOf(scaleOf(data), centre(index))) });
    });
    const limits = (data.tolerance ?? []).filter((value) => value > data.low && value < data.high).map((value) =>
        svgElement("line", { class: "limit", x1: at(value), x2: at(value), y1: 0, y2: height }));
    return element("figure", { class: isCurrent ? "histogram current" : "histogram" },
        svgElement("svg", { viewBox: `0 0 ${width} ${height + 1}`, preserveAspectRatio: "none", role: "img", "aria-label": `Histogram of ${title}. ${description(data, unit)}` },
            band, bars, limits, svgElement("line", { class: "base", x1: 0, x2: width, y1: height + 0.5, y2: height + 0.5 })),
        element("figcaption", null, title));
}

/// The histogram in words.
export function description(data: Histogram, unit: string): string {
    const most = data.shares.reduce((best, share, index) => (share > data.shares[best]! ? index : best), 0);
    const width = (data.high - data.low) / data.shares.length;
    const from = data.low + most * width;
    const end = unit ? ` ${unit}` : "";
    const tolerance = data.tolerance ? `; tolerance ${format.signed(data.tolerance[0])} to ${format.signed(data.tolerance[1])}${end}` : "";
    return `Most, ${format.percent(data.shares[most] ?? 0)}, from ${format.signed(from)} to ${format.signed(from + width)}${end}${tolerance}.`;
}
