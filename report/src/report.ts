// SPDX-License-Identifier: GPL-3.0-or-later
/// The data with the look-ups that the page needs: cells by id, rows of scans, columns of variants, values by metric.

import type { Cell, Change, Histogram, MetricInfo, ReportData, Trend } from "./data.ts";
import type { ColourScale } from "./colour_scale.ts";
import { scaleOf } from "./colour_scale.ts";
import * as format from "./format.ts";

export interface Column {
    workflow: string;
    variant: string;
    title: string;
}

/// A scan with one cell per column; undefined where the page has none.
export interface Row {
    scan: string;
    cells: (Cell | undefined)[];
}

/// A value of a metric. `text` has the unit.
export interface Reading {
    value: number | null;
    text: string;
    unit: string;
}

export class Report {
    readonly columns: Column[] = [];
    readonly rows: Row[] = [];
    private readonly cells = new Map<number, Cell>();
    private readonly rowOfScan = new Map<string, Row>();
    private readonly changesByCell = new Map<number, Change[]>();
    private readonly trendsByCell = new Map<number, Trend[]>();
    private readonly metrics = new Map<string, MetricInfo>();

    constructor(readonly data: ReportData) {
        const columnOf = new Map<string, number>();
        const severalWorkflows = new Set(data.cells.map((cell) => cell.workflow)).size > 1;
        for (const cell of data.cells) {
            this.cells.set(cell.id, cell);
            const key = JSON.stringify([cell.workflow, cell.variant]);
            let column = columnOf.get(key);
            if (column === undefined) {
                column = this.columns.length;
                columnOf.set(key, column);
                const title = severalWorkflows ? `${cell.workflow} · ${cell.variant}` : cell.variant;
                this.columns.push({ workflow: cell.workflow, variant: cell.variant, title });
            }
            let row = this.rowOfScan.get(cell.scan);
            if (!row) {
                row = { scan: cell.scan, cells: [] };
                this.rowOfScan.set(cell.scan, row);
                this.rows.push(row);
            }
            row.cells[column] = cell;
        }
        for (const change of data.changes) push(this.changesByCell, change.cell, change);
        for (const trend of data.trends) push(this.trendsByCell, trend.cell, trend);
        for (const metric of data.metrics) this.metrics.set(metric.name, metric);
    }

    cell(id: number): Cell | undefined {
        return this.cells.get(id);
    }

    metric(name: string): MetricInfo | undefined {
        return this.metrics.get(name);
    }

    changesOf(cell: Cell): Change[] {
        return this.changesByCell.get(cell.id) ?? [];
    }

    trendsOf(cell: Cell): Trend[] {
        return this.trendsByCell.get(cell.id) ?? [];
    }

    row(scan: string): Row | undefined {
        return this.rowOfScan.get(scan);
    }

    /// All cells of the same scan, the cell itself included, in the order of the columns.
    variantsOf(cell: Cell): Cell[] {
        return (this.rowOfScan.get(cell.scan)?.cells ?? []).filter((other) => other !== undefined);
    }

    /// The title of a cell's column.
    title(cell: Cell): string {
        const column = this.columns.find((one) => one.workflow === cell.workflow && one.variant === cell.variant);
        return column?.title ?? cell.variant;
    }

    image(key: string | undefined): string | undefined {
        return key === undefined ? undefined : this.data.images[key];
    }

    /// The scale of the colours of the cell's deviations, or else of the scan's other cells; null if none has deviations.
    deviationScale(cell: Cell): ColourScale | null {
        const cells = [cell, ...this.variantsOf(cell).filter((other) => other !== cell)];
        const histogram = cells.map((other) => other.histogram).find((one): one is Histogram => one !== null);
        if (histogram) return scaleOf(histogram);
        const meshes = cells.map((other) => (other.mesh ? this.data.meshes[other.mesh] : undefined));
        const coloured = meshes.filter((mesh) => mesh !== undefined && mesh.deviation !== null);
        if (coloured.length === 0) return null;
        const low = Math.min(...coloured.map((mesh) => mesh!["deviation-low"]));
        const high = Math.max(...coloured.map((mesh) => mesh!["deviation-high"]));
        return { low, high, tolerance: null };
    }

    reading(cell: Cell, metric: string): Reading | null {
        const value = cell.values.find((one) => one.name === metric);
        if (value) return { value: value.value, text: value.text, unit: unitOf(value.text) };
        if (cell.steps.length === 0 && metric !== "seconds") return null;
        switch (metric) {
            case "seconds":
                return { value: cell.seconds, text: format.seconds(cell.seconds), unit: "s" };
            case "cpu-seconds": {
                const sum = cell.steps.reduce((total, step) => total + step["cpu-seconds"], 0);
                return { value: sum, text: format.seconds(sum), unit: "s" };
            }
            case "memory": {
                const most = Math.max(...cell.steps.map((step) => step.memory));
                return { value: most, text: format.bytes(most), unit: "B" };
            }
            default:
                return null;
        }
    }
}

/// `mm` in `0.12 mm`; empty without a unit. Units of which the program chooses the prefix by size, as `ms` or `MB`, are
/// one unit: their values are all seconds or bytes.
export function unitOf(text: string): string {
    const unit = /^[-+−]?[\d.,]+(?:e[-+]?\d+)?\s*(.*)$/i.exec(text)?.[1] ?? "";
    if (/^(µs|ms|s|min|h)\b/.test(unit)) return "s";
    return /^[kMGT]?i?B$/.test(unit) ? "B" : unit;
}

/// The last part of a path and what is before it.
export function splitPath(path: string): [folder: string, name: string] {
    const end = path.lastIndexOf("/") + 1;
    return [path.slice(0, end), path.slice(end)];
}

function push<Key, Item>(map: Map<Key, Item[]>, key: Key, item: Item): void {
    const list = map.get(key);
    if (list) list.push(item);
    else map.set(key, [item]);
}
