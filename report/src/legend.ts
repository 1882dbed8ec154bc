// SPDX-License-Identifier: GPL-3.0-or-later
/// The legend of deviations.

import { colourOf, css } from "./colour_scale.ts";
import type { ColourScale } from "./colour_scale.ts";
import { element, svgElement } from "./element.ts";
import * as format from "./format.ts";

const steps = 80;

export function legend(scale: ColourScale, unit: string): HTMLElement {
    const width = scale.high - scale.low || 1;
    const at = (value: number) => ((value - scale.low) / width) * 100;
    const bars = Array.from({ length: steps }, (_, index) => {
        const colour = css(colourOf(scale, scale.low + ((index + 0.5) / steps) * width));
        return svgElement("rect", { x: (index / steps) * 100, y: 0, width: 100 / steps + 0.2, height: 10, fill: colour });
    });
    const marks = [scale.low, ...(scale.tolerance ?? []), ...(scale.low < 0 && scale.high > 0 ? [0] : []), scale.high];
    const values = [...new Set(marks)].filter((value) => value >= scale.low && value <= scale.high).sort((a, b) => a - b);
    const text = `Colours of the deviation from ${format.signed(scale.low)} to ${format.signed(scale.high)} ${unit}: blue is inside, white is 0, red is outside.`;
    return element("div", { class: "legend", role: "img", "aria-label": text },
        svgElement("svg", { viewBox: "0 0 100 10", preserveAspectRatio: "none", "aria-hidden": "true" }, bars),
        element("div", { class: "ticks", "aria-hidden": "true" }, values.map((value) =>
            element("span", { style: { left: `${at(value)}%` }, class: value === scale.low ? "first" : value === scale.high ? "last" : null }, format.signed(value)))),
        element("div", { class: "ends", "aria-hidden": "true" }, element("span", null, "inside"), element("span", null, `deviation${unit ? ` in ${unit}` : ""}`), element("span", null, "outside")));
}
