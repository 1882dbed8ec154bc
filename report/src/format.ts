// SPDX-License-Identifier: GPL-3.0-or-later
/// Numbers, times and sizes as people read them.

const grouped = new Intl.NumberFormat("en", { maximumFractionDigits: 0 });

export function count(value: number): string {
    return grouped.format(value);
}

/// `1 cell`, `2 cells`.
export function counted(value: number, noun: string): string {
    return `${count(value)} ${noun}${value === 1 ? "" : "s"}`;
}

/// Four significant digits, without an exponent where that is readable.
export function number(value: number): string {
    if (value === 0) return "0";
    const size = Math.abs(value);
    if (size >= 1e15 || size < 1e-4) return value.toExponential(2);
    if (size >= 1000) return grouped.format(value);
    return String(Number(value.toPrecision(4)));
}

export function signed(value: number): string {
    return (value > 0 ? "+" : "") + number(value).replace("-", "−");
}

export function seconds(value: number): string {
    if (value >= 3600) return `${Math.floor(value / 3600)} h ${Math.round((value % 3600) / 60)} min`;
    if (value >= 120) return `${Math.floor(value / 60)} min ${Math.round(value % 60)} s`;
    if (value >= 1) return `${value.toFixed(value < 10 ? 2 : 1)} s`;
    return value === 0 ? "0 s" : `${Number((value * 1000).toPrecision(2))} ms`;
}

export function bytes(value: number): string {
    const units = ["B", "kB", "MB", "GB", "TB"];
    let unit = 0;
    while (value >= 1000 && unit < units.length - 1) {
        value /= 1000;
        ++unit;
    }
    return `${unit === 0 ? value : value.toPrecision(3)} ${units[unit]}`;
}

/// `2026-11-28 02:15 UTC`; a text that is no ISO time stays as it is.
export function time(iso: string): string {
    const found = /^(\d{4}-\d\d-\d\d)T(\d\d:\d\d)(?::\d\d(?:\.\d+)?)?(Z|\+00:00)?$/.exec(iso);
    return found ? `${found[1]} ${found[2]}${found[3] ? " UTC" : ""}` : iso;
}

export function day(iso: string): string {
    return /^\d{4}-\d\d-\d\d/.exec(iso)?.[0] ?? iso;
}

export function percent(share: number): string {
    return `${number(share * 100)} %`;
}
