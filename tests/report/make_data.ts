// SPDX-License-Identifier: GPL-3.0-or-later
/// Writes pages with made-up data into a folder: make_data REPORT-TEMPLATE SHEET-TEMPLATE FOLDER.

import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import type { Cell, Change, Histogram, ReportData, Run, Step, Verdict } from "../../report/src/data.ts";
import * as format from "../../report/src/format.ts";
import { inspectedValues, makeInspection, sheetSets } from "./make_inspections.ts";
import { encode, picture, random, torus } from "./shapes.ts";
import type { Shape } from "./shapes.ts";

const place = '<script type="application/json" id="data">null</script>';
const allVariants = ["default", "fine", "coarse", "smooth", "poisson", "tight-cocone"];

interface Options {
    batch: string;
    scans: number;
    variants: string[];
    runs: number;
    isAccepted: boolean;
    /// Without them the cells have numbers only.
    hasPictures: boolean;
    pictureWidth?: number;
    workflows?: string[];
}

interface Scan {
    path: string;
    unit: string;
    size: number;
    hasTruth: boolean;
}

function scanOf(index: number): Scan {
    if (index === 1) return { path: "scans/we ird'<script>.ply", unit: "mm", size: 80, hasTruth: true };
    if (index === 4) return { path: "scans/museum/lion.e57", unit: "m", size: 1.8, hasTruth: false };
    const shape = ["torus", "plate", "bracket", "housing", "impeller"][index % 5]!;
    const unit = index % 7 === 3 ? "u" : "mm";
    return { path: `scans/${index % 3 === 0 ? "nightly/" : ""}${shape}-${String(index + 1).padStart(2, "0")}.ply`, unit, size: 40 + 7 * (index % 11), hasTruth: index % 6 !== 2 };
}

function verdictOf(scan: number, variant: number, isAccepted: boolean): Verdict {
    const key = scan * 6 + variant;
    if (scan === 2 && variant === 3) return "failed";
    if (scan === 9 && variant === 5) return "failed";
    if (!isAccepted) return scan === 3 && variant === 0 ? "doubtful" : "new";
    if (scan === 12 && variant === 5) return "missing";
    if ((scan === 0 && variant < 2) || (scan === 1 && variant === 0) || key % 97 === 60) return "regressed";
    if ((scan === 3 && variant < 2) || key % 89 === 50) return "doubtful";
    if (key % 23 === 11) return "improved";
    return scan === 17 ? "new" : "passed";
}

export function makeData(options: Options): ReportData {
    const data: ReportData = {
        scanmill: 1, batch: options.batch, verdict: "passed", folder: `out/${options.batch}`, counts: {},
        run: run(130, 0), accepted: options.isAccepted ? run(118, 12) : null,
        acceptance: options.isAccepted ? { who: "Ann", why: "looked at every mesh", at: "2026-11-16T08:12:00Z" } : null,
        facts: [
            ["version", options.isAccepted ? "1.4.0 → 1.5.0-dev (bdeee11)" : "1.5.0-dev (bdeee11)"], ["machine", "mill-3: 16 × AMD EPYC 7302P, 64 GB, Debian 12"],
            ["gate", "hausdorff +1 %, triangles 5 %, genus exact, cpu-seconds +20 %"], ["changed filters", "voxel-thin 2 → 3, alpha-solid 5 → 6"],
        ],
        "default-metric": "hausdorff",
        metrics: [
            { name: "hausdorff", unit: "", better: "smaller" }, { name: "f-score", unit: "", better: "larger" }, { name: "triangles", unit: "", better: null },
            { name: "genus", unit: "", better: null }, { name: "seconds", unit: "s", better: "smaller" }, { name: "cpu-seconds", unit: "s", better: "smaller" },
            { name: "memory", unit: "B", better: "smaller" },
        ],
        rules: [], cells: [], changes: [], runs: [], trends: [], images: {}, meshes: {}, notes: [],
    };
    for (let index = 0; index < options.runs; ++index) {
        const one = run(131 - options.runs + index, options.runs - 1 - index);
        data.runs.push({ id: one.id, started: one.started, accepted: options.isAccepted && (one.id === 118 || one.id === 104), verdict: index % 9 === 5 ? "regressed" : "passed" });
    }
    const [width, height] = sizeOf(options);
    const workflows = options.workflows ?? ["solid"];
    for (let index = 0; index < options.scans; ++index) {
        const scan = scanOf(index);
        const shapes = { truth: torus(scan.size, 0, 1), scan: torus(scan.size, scan.size * 0.002, index, 70, 30) };
        if (options.hasPictures) {
            if (scan.hasTruth) data.images[`truth-${index}`] = picture(shapes.truth, null, width, height);
            data.images[`scan-${index}`] = picture(shapes.scan, null, width, height, true);
        }
        for (const workflow of workflows) {
            options.variants.forEach((variant, at) => addCell(data, options, scan, index, workflow, variant, at));
        }
    }
    finish(data, options);
    return data;
}

function addCell(data: ReportData, options: Options, scan: Scan, index: number, workflow: string, variant: string, at: number): void {
    const id = data.cells.length + 1;
    const next = random(id * 7919);
    const verdict = verdictOf(index, at, options.isAccepted);
    const hasResult = verdict !== "failed" && verdict !== "missing";
    const waves = scan.size * (0.003 + 0.002 * at + 0.002 * next());
    const before = waves * (verdict === "regressed" ? 0.72 : verdict === "improved" ? 1.3 : 1);
    const step = 0.2 + next() * 2;
    const cell: Cell = {
        id, workflow, scan: scan.path, variant, verdict, outcome: verdict === "failed" ? "failed" : verdict === "missing" ? "skipped" : verdict === "doubtful" ? "doubtful" : "ok",
        seconds: hasResult ? 3.4 * step : 1.2, reasons: [], causes: [], doubts: [], warnings: [], known: null,
        command: `scanmill batch library.yaml --scan ${quoted(scan.path)} --only ${variant} -o reproduced`, error: "", log: "", values: [], steps: [], outputs: [], pictures: {}, mesh: null,
        "deviation-unit": scan.unit, histogram: null, inspection: null,
    };
    data.cells.push(cell);
    data.counts[verdict] = (data.counts[verdict] ?? 0) + 1;
    describe(cell);
    cell.steps = steps(step, verdict === "failed", index % 4 === 2);
    if (!hasResult) return;

    const length = (value: number) => `${format.number(value)} ${scan.unit}`;
    const triangles = Math.round(4000 + 900 * at + 600 * next());
    const isOther = options.isAccepted && verdict !== "new";
    const accepted = (text: string) => (isOther ? text : null);
    if (scan.hasTruth) {
        cell.values.push({ source: "measure", name: "hausdorff", value: waves, text: length(waves), accepted: accepted(length(before)) });
        cell.values.push({ source: "measure", name: "f-score", value: 1 - 8 * waves / scan.size, text: (1 - (8 * waves) / scan.size).toFixed(4), accepted: accepted((1 - (8 * before) / scan.size).toFixed(4)) });
    }
    cell.values.push({ source: `${scan.path.split("/").at(-1)}`, name: "triangles", value: triangles, text: String(triangles), accepted: accepted(String(triangles)) });
    cell.values.push({ source: `${scan.path.split("/").at(-1)}`, name: "genus", value: 1, text: "1", accepted: accepted("1") });
    cell.values.push({ source: "voxel-thin", name: "points", value: 26592, text: "26592", accepted: accepted("26592") });
    cell.outputs = [{ file: `${scan.path.split("/").at(-1)}`, bytes: 128000 + 11 * id, sha256: "9f2c4e1a".repeat(8) }];
    if (isOther && before !== waves && scan.hasTruth) addChange(data.changes, cell, length(before), length(waves), waves / before - 1);
    data.runs.length > 1 && addTrends(data, cell, waves, before, triangles, next);
    if (scan.hasTruth) cell.histogram = histogramOf(scan.size, waves);
    if (!options.hasPictures) return;

    const shape = torus(scan.size, waves, id);
    const [width, height] = sizeOf(options);
    cell.pictures = { scan: `scan-${index}`, result: `result-${id}` };
    data.images[`result-${id}`] = picture(shape, null, width, height);
    if (scan.hasTruth) {
        cell.pictures.truth = `truth-${index}`;
        cell.pictures.deviation = `deviation-${id}`;
        data.images[`deviation-${id}`] = picture(shape, cell.histogram, width, height);
    }
    if (isOther && before !== waves) {
        cell.pictures.accepted = `accepted-${id}`;
        data.images[`accepted-${id}`] = picture(torus(scan.size, before, id + 1), null, width, height);
    }
    if (index < 6) {
        cell.mesh = `mesh-${id}`;
        data.meshes[cell.mesh] = encode(shape as Shape, scan.hasTruth);
    }
}

function sizeOf(options: Options): [width: number, height: number] {
    const width = options.pictureWidth ?? 240;
    return [width, 0.75 * width];
}

function describe(cell: Cell): void {
    switch (cell.verdict) {
        case "failed":
            cell.reasons = ["alpha-solid failed"];
            cell.error = "error: needs at least 4 points that are not coplanar; the cloud has 812, all within 1e-9 u of one plane\n  in step 'delaunay' (solid.yaml:8:5)\n  on scan '" + cell.scan + "'\nhint: voxel-thin and region-grow accept flat scans";
            cell.log = Array.from({ length: 40 }, (_, line) => `02:15:${String(line + 10)} alpha-solid: ball ${line + 1} of 40, ${line * 113} cells <tested>`).join("\n");
            break;
        case "missing": cell.reasons = ["the run was interrupted before this cell"]; break;
        case "regressed":
            cell.reasons = ["hausdorff is larger by more than +1 %"];
            cell.causes = ["voxel-thin: bin-size 2 %diag → 3 %diag", "alpha-solid: version 5 → 6"];
            break;
        case "doubtful":
            cell.reasons = ["alpha-solid doubts its result"];
            cell.doubts = ["alpha 75.38 u is 11 times the boundary's median edge, to span gaps or to reach distant points"];
            if (cell.id % 2 === 0) cell.known = { who: "Ben", why: "the scanner does not see the bore", at: "2026-11-20T10:00:00Z" };
            break;
        case "improved": cell.causes = ["alpha-solid: version 5 → 6"]; break;
    }
    if (cell.id % 5 === 0) cell.warnings = ["voxel-thin: %diag is 346.383 u, the diagonal of the box without 1 stray point"];
}

function steps(seconds: number, hasFailed: boolean, isCached: boolean): Step[] {
    const make = (label: string, filter: string, share: number, memory: number, parameters: [string, string][], origin = "ran", outcome = "ok"): Step => ({
        label, filter, version: 3, seconds: origin === "ran" ? seconds * share : 0.004, "cpu-seconds": origin === "ran" ? seconds * share * 3.1 : 0.004, memory: memory * 1e6, origin, outcome, parameters,
    });
    return [
        make("read", "read", 0.2, 48, [], isCached ? "cached" : "ran"),
        make("voxel-thin", "voxel-thin", 0.3, 61, [["bin-size", "3 %diag"], ["keep", "nearest"]], isCached ? "cached" : "ran"),
        make("delaunay", "delaunay", 1.1, 212, []),
        hasFailed ? make("surface", "alpha-solid", 0.5, 340, [["alpha", "auto"]], "ran", "failed") : make("surface", "alpha-solid", 1.4, 340, [["alpha", "auto"]]),
        ...(hasFailed ? [] : [make("measure", "measure", 0.4, 150, [["samples", "100000"], ["tolerance", "0.1 mm"]])]),
    ];
}

function histogramOf(size: number, waves: number): Histogram {
    const tolerance = size * 0.006;
    const [bins, high] = [25, 2 * tolerance];
    const weights = Array.from({ length: bins }, (_, bin) => Math.exp(-((((bin + 0.5 - bins / 2) / (bins / 2)) * high) ** 2) / (2 * (0.6 * waves) ** 2)));
    const sum = weights.reduce((a, b) => a + b);
    return { low: -high, high, shares: weights.map((weight) => weight / sum), tolerance: [-tolerance, tolerance] };
}

function addChange(changes: Change[], cell: Cell, accepted: string, found: string, share: number): void {
    const text = `${share > 0 ? "+" : "−"}${format.number(Math.abs(share) * 100)} %`;
    changes.push({ cell: cell.id, what: "hausdorff", accepted, found, change: text, share, rule: "+1 %", effect: share > 0 ? "regression" : "improvement" });
    changes.push({ cell: cell.id, what: cell.outputs[0]?.file ?? "output", accepted: "9f2c4e1a…", found: "77ab0c31…", change: "changed", share: null, rule: "", effect: "listed" });
    changes.push({ cell: cell.id, what: "cells", accepted: "20442", found: "19113", change: "−6.5 %", share: -0.065, rule: "", effect: "listed" });
}

function addTrends(data: ReportData, cell: Cell, now: number, before: number, triangles: number, next: () => number): void {
    const last = data.runs.length - 1;
    const values = data.runs.map((_, index) => (index === 4 ? null : index === last ? now : before * (0.98 + 0.04 * next())));
    data.trends.push({ cell: cell.id, metric: "hausdorff", values: values.map((value) => value && Number(value.toPrecision(5))) });
    data.trends.push({ cell: cell.id, metric: "triangles", values: data.runs.map(() => triangles + Math.round(20 * next())) });
}

function finish(data: ReportData, options: Options): void {
    const order = ["regression", "improvement", "listed"];
    data.changes.sort((a, b) => order.indexOf(a.effect) - order.indexOf(b.effect) || Math.abs(b.share ?? 0) - Math.abs(a.share ?? 0));
    data.verdict = (["regressed", "missing", "failed", "doubtful"] as const).find((verdict) => data.counts[verdict]) ?? (options.isAccepted ? (data.counts.improved ? "improved" : "passed") : "new");
    if (options.isAccepted) {
        for (const variant of options.variants) {
            const cells = data.cells.filter((cell) => cell.variant === variant);
            const regressed = cells.filter((cell) => cell.verdict === "regressed").length;
            data.rules.push({ metric: "hausdorff", rule: "+1 %", variant, cells: cells.length, median: "0.3127", "median-change": regressed > 1 ? "+4.1 %" : "+0 %", regressed });
            data.rules.push({ metric: "genus", rule: "exact", variant, cells: cells.length, median: "1", "median-change": "+0 %", regressed: 0 });
        }
    }
    if (options.hasPictures && options.scans > 6) data.notes.push(`${data.cells.length - Object.keys(data.meshes).length} views in 3D were left out, because the page would be larger than 15 MB.`);
}

function run(id: number, daysAgo: number): Run {
    return { id, started: new Date(Date.UTC(2026, 10, 28, 2, 15) - daysAgo * 86400000).toISOString(), version: daysAgo > 5 ? "1.4.0" : "1.5.0-dev", machine: "mill-3", threads: 4, jobs: 4, seconds: 1834 + id };
}

function quoted(path: string): string {
    return /^[\w./-]+$/.test(path) ? path : `'${path.replaceAll("'", "'\\''")}'`;
}

export const sets: Record<string, () => ReportData> = {
    nightly: () => makeData({ batch: "library", scans: 50, variants: allVariants, runs: 30, isAccepted: true, hasPictures: true }),
    small: () => makeData({ batch: "library", scans: 14, variants: allVariants, runs: 30, isAccepted: true, hasPictures: true, pictureWidth: 120 }),
    first: () => makeData({ batch: "first-night", scans: 5, variants: ["default", "fine"], runs: 1, isAccepted: false, hasPictures: true, workflows: ["solid", "open"] }),
    one: () => makeData({ batch: "one", scans: 1, variants: ["default"], runs: 3, isAccepted: true, hasPictures: true }),
    none: () => makeData({ batch: "none", scans: 0, variants: [], runs: 0, isAccepted: false, hasPictures: false }),
    inspected: () => inspected(),
    many: () => makeData({ batch: "many", scans: 1250, variants: [...allVariants, "seventh", "eighth"], runs: 30, isAccepted: true, hasPictures: false }),
};

/// Cells that inspected a part: cell 1 with parts, cell 2 without parts and limit and with a histogram from its inspection
/// alone. Cell 3 did not inspect.
function inspected(): ReportData {
    const data = makeData({ batch: "inspected", scans: 1, variants: ["default", "fine", "coarse"], runs: 1, isAccepted: false, hasPictures: true });
    const [first, second] = data.cells;
    first!.inspection = makeInspection({ mean: 0.04, deviation: 0.04, parts: 40, labels: 20, seed: 1 });
    second!.inspection = makeInspection({ mean: 0.01, deviation: 0.02, parts: 0, labels: 3, seed: 2, hasLimit: false });
    second!.histogram = null;
    for (const cell of [first!, second!]) cell.values.unshift(...inspectedValues(cell.inspection!));
    return data;
}

const [reportTemplate, sheetTemplate, folder] = process.argv.slice(2);
if (reportTemplate && sheetTemplate && folder) {
    mkdirSync(folder, { recursive: true });
    write(reportTemplate, folder, "empty", sets);
    write(sheetTemplate, folder, "sheet-empty", sheetSets);
}

/// Fills the template with every set; `empty` is the name of the page without data.
function write(template: string, folder: string, empty: string, from: Record<string, () => unknown>): void {
    const page = readFileSync(template, "utf8");
    if (page.split(place).length !== 2) throw new Error(`${template} has no place for the data`);
    for (const [name, make] of Object.entries(from)) {
        const json = JSON.stringify(make()).replaceAll("<", "\\u003c");
        writeFileSync(`${folder}/${name}.html`, page.replace(place, () => place.replace("null", () => json)));
    }
    writeFileSync(`${folder}/${empty}.html`, page);
}
