// SPDX-License-Identifier: GPL-3.0-or-later
/// A histogram of deviations with axes: the deviation with its unit, the share of the points, the tolerance as a band.

import { colourOf, css, scaleOf } from "./colour_scale.ts";
import type { Histogram } from "./data.ts";
import { element, svgElement } from "./element.ts";
import * as format from "./format.ts";
import { description } from "./histogram.ts";

const [width, height] = [360, 164];
const area = { left: 34, right: 346, top: 18, bottom: 128 };
/// Least distance between two numbers below the axis.
const labelDistance = 36;

export function deviationChart(data: Histogram, unit: string): HTMLElement {
    const scale = scaleOf(data);
    const top = niceTop(Math.max(...data.shares, 0));
    const bin = (area.right - area.left) / data.shares.length;
    const x = (value: number) => area.left + clamp((value - data.low) / (data.high - data.low || 1)) * (area.right - area.left);
    const y = (share: number) => area.bottom - clamp(share / top) * (area.bottom - area.top);
    const bars = data.shares.map((share, index) => {
        const centre = data.low + ((index + 0.5) / data.shares.length) * (data.high - data.low);
        return svgElement("rect", { class: "bar", x: area.left + (index + 0.05) * bin, y: y(share), width: bin * 0.9, height: area.bottom - y(share), fill: css(colourOf(scale, centre)) });
    });
    const grid = [top / 2, top].map((share) => [
        svgElement("line", { class: "grid", x1: area.left, x2: area.right, y1: y(share), y2: y(share) }),
        svgElement("text", { x: area.left - 4, y: y(share) + 3, "text-anchor": "end" }, format.percent(share)),
    ]);
    const ticks = ticksOf(data, x).map((value) => [
        svgElement("line", { class: "base", x1: x(value), x2: x(value), y1: area.bottom, y2: area.bottom + 4 }),
        svgElement("text", { x: x(value), y: area.bottom + 14, "text-anchor": "middle" }, format.signed(value)),
    ]);
    return element("figure", { class: "deviation-chart" },
        svgElement("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `Histogram of the deviations. ${description(data, unit)}` },
            data.tolerance && band(data.tolerance, x), grid, bars,
            svgElement("line", { class: "base", x1: area.left, x2: area.right, y1: area.bottom, y2: area.bottom }), ticks,
            svgElement("text", { x: area.left - 30, y: 9 }, "share of the points"),
            svgElement("text", { x: (area.left + area.right) / 2, y: height - 6, "text-anchor": "middle" }, unit ? `deviation in ${unit}` : "deviation")),
        element("figcaption", null, "The outer bars also count all points beyond them."));
}

function band(tolerance: [number, number], x: (value: number) => number): SVGElement[] {
    const [from, to] = [x(tolerance[0]), x(tolerance[1])];
    return [
        svgElement("rect", { class: "band", x: from, y: area.top, width: to - from, height: area.bottom - area.top }),
        ...[from, to].map((at) => svgElement("line", { class: "limit", x1: at, x2: at, y1: area.top, y2: area.bottom })),
        svgElement("text", { x: (from + to) / 2, y: area.top - 4, "text-anchor": "middle", class: "band-name" }, "tolerance"),
    ];
}

/// The ends of the tolerance, the ends of the range and 0, without those too close to one before.
function ticksOf(data: Histogram, x: (value: number) => number): number[] {
    const chosen: number[] = [];
    for (const value of [...(data.tolerance ?? []), data.low, data.high, 0]) {
        const isInside = value >= data.low && value <= data.high;
        if (isInside && chosen.every((other) => Math.abs(x(other) - x(value)) >= labelDistance)) chosen.push(value);
    }
    return chosen;
}

function niceTop(most: number): number {
    if (!(most > 0)) return 1;
    const power = 10 ** Math.floor(Math.log10(most));
    return Math.min(1, (([1, 2, 4, 5, 6, 8, 10].find((factor) => factor * power >= most * 0.999) ?? 10) * power));
}

function clamp(share: number): number {
    return Math.min(Math.max(share, 0), 1);
}
