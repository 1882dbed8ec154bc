// SPDX-License-Identifier: GPL-3.0-or-later
/// Shares of values in a range, for the colours of the matrix. 1 is the worst value, or the largest without a direction.

import type { MetricInfo } from "./data.ts";
import type { Reading, Report, Row } from "./report.ts";

export type Scope = "row" | "all";

interface Range {
    low: number;
    high: number;
}

export class Heat {
    private readonly ranges = new Map<string, Range>();
    private readonly better: MetricInfo["better"];
    /// The units of the metric's values, in order of appearance.
    readonly units: string[] = [];

    constructor(report: Report, readonly metric: string, readonly scope: Scope) {
        this.better = report.metric(metric)?.better ?? null;
        for (const row of report.rows) {
            for (const cell of row.cells) {
                const reading = cell && report.reading(cell, metric);
                if (!reading || reading.value === null) continue;
                if (!this.units.includes(reading.unit)) this.units.push(reading.unit);
                const key = this.key(row, reading);
                const range = this.ranges.get(key);
                if (!range) this.ranges.set(key, { low: reading.value, high: reading.value });
                else {
                    range.low = Math.min(range.low, reading.value);
                    range.high = Math.max(range.high, reading.value);
                }
            }
        }
    }

    share(row: Row, reading: Reading): number {
        const range = this.ranges.get(this.key(row, reading));
        if (!range || reading.value === null || range.high === range.low) return 0;
        const share = (reading.value - range.low) / (range.high - range.low);
        return this.better === "larger" ? 1 - share : share;
    }

    sentence(): string {
        const darker = this.better === null ? "larger" : "worse";
        const range = this.scope === "row" ? "of its scan" : "of all scans";
        const units = this.scope === "all" && this.units.length > 1
            ? ` Values in ${this.units.map((unit) => unit || "no unit").join(" and in ")} have ranges of their own.`
            : "";
        return `Darker is ${darker}, within the values ${range}.${units}`;
    }

    /// Values in different units cannot be compared, so each unit has its own range.
    private key(row: Row, reading: Reading): string {
        return this.scope === "row" ? JSON.stringify([row.scan, reading.unit]) : reading.unit;
    }
}
