// SPDX-License-Identifier: GPL-3.0-or-later
/// Which rows of the matrix are shown, and in which order.

import type { Cell, Verdict } from "./data.ts";
import * as format from "./format.ts";
import type { Report, Row } from "./report.ts";
import { troubles } from "./verdict.ts";

/// `column` is null for the name of the scan.
export interface Order {
    column: number | null;
    descending: boolean;
}

const byName = new Intl.Collator("en", { numeric: true });

/// Rows without a value come last in both directions; values in different units are not mixed.
export function sorted(report: Report, rows: Row[], metric: string, order: Order): Row[] {
    const sign = order.descending ? -1 : 1;
    const column = order.column;
    if (column === null) return [...rows].sort((a, b) => sign * byName.compare(a.scan, b.scan));
    const keyed = rows.map((row) => {
        const cell = row.cells[column];
        return { row, reading: cell ? report.reading(cell, metric) : null };
    });
    keyed.sort((a, b) => {
        const [left, right] = [a.reading?.value ?? null, b.reading?.value ?? null];
        if (left === null || right === null) return Number(left === null) - Number(right === null);
        return byName.compare(a.reading!.unit, b.reading!.unit) || sign * (left - right) || byName.compare(a.row.scan, b.row.scan);
    });
    return keyed.map(({ row }) => row);
}

/// Rows whose scan has all words of `text` in its name, and that have a cell with one of the verdicts.
export function filtered(rows: Row[], text: string, chosen: ReadonlySet<Verdict>): Row[] {
    const words = text.toLowerCase().split(/\s+/).filter((word) => word !== "");
    return rows.filter(
        (row) =>
            words.every((word) => row.scan.toLowerCase().includes(word)) &&
            (chosen.size === 0 || row.cells.some((cell) => cell && chosen.has(cell.verdict))),
    );
}

/// `3 failed, 1 regressed`; empty if no cell of the rows needs a person.
export function troublesIn(rows: Row[]): string {
    const numbers = new Map<Verdict, number>();
    for (const row of rows) {
        for (const cell of row.cells as (Cell | undefined)[]) {
            if (cell) numbers.set(cell.verdict, (numbers.get(cell.verdict) ?? 0) + 1);
        }
    }
    return troubles
        .filter((verdict) => numbers.has(verdict))
        .map((verdict) => `${format.count(numbers.get(verdict)!)} ${verdict}`)
        .join(", ");
}
