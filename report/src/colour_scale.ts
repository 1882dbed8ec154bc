// SPDX-License-Identifier: GPL-3.0-or-later
/// Colours of deviations. The same scale as the program's pictures, geometry/colour/colour_scale.hpp: blue below 0,
/// nearly white at 0, orange and red above, the lightest fifth of each half for values in tolerance.

import type { Histogram } from "./data.ts";

export type Colour = [number, number, number];

export interface ColourScale {
    low: number;
    high: number;
    tolerance: [number, number] | null;
}

export const noData: Colour = [160, 160, 160];

const below: Colour[] = [[246, 244, 240], [196, 220, 238], [124, 178, 220], [62, 128, 190], [26, 82, 146], [10, 44, 92]];
const above: Colour[] = [[246, 244, 240], [250, 216, 178], [244, 162, 98], [222, 102, 52], [178, 46, 30], [112, 12, 28]];
const bandEnd = 0.2;

export function scaleOf(histogram: Histogram): ColourScale {
    return { low: histogram.low, high: histogram.high, tolerance: histogram.tolerance };
}

export function colourOf(scale: ColourScale, value: number): Colour {
    if (Number.isNaN(value)) return noData;
    const [toleranceLow, toleranceHigh] = scale.tolerance ?? [0, 0];
    const isOut = scale.tolerance !== null && (value < toleranceLow || value > toleranceHigh);
    const neutral = Math.min(Math.max(0, scale.low), scale.high);
    const inside = Math.min(Math.max(value, scale.low), scale.high);
    const isBelow = inside < neutral;
    let share = isBelow
        ? shareOf(neutral - inside, neutral - toleranceLow, neutral - scale.low)
        : shareOf(inside - neutral, toleranceHigh - neutral, scale.high - neutral);
    if (isOut) share = Math.max(share, bandEnd);
    return colourIn(isBelow ? below : above, share);
}

export function css(colour: Colour): string {
    return `rgb(${colour.join(" ")})`;
}

function shareOf(distance: number, band: number, length: number): number {
    if (!(distance > 0)) return 0;
    if (distance >= length) return 1;
    if (!(band > 0 && band < length)) return distance / length;
    if (distance <= band) return bandEnd * (distance / band);
    return bandEnd + (1 - bandEnd) * ((distance - band) / (length - band));
}

function colourIn(half: Colour[], share: number): Colour {
    const at = share * (half.length - 1);
    const step = Math.min(Math.floor(at), half.length - 2);
    const rest = at - step;
    const [from, to] = [half[step] ?? noData, half[step + 1] ?? noData];
    return [0, 1, 2].map((channel) => Math.floor((1 - rest) * from[channel]! + rest * to[channel]! + 0.5)) as Colour;
}
