// SPDX-License-Identifier: GPL-3.0-or-later
/// Made-up inspections: of the cells of a report page, and the data of inspection sheets.

import type { Histogram, Inspection, Sheet, SheetData, Value } from "../../report/src/data.ts";
import { picture, random, torus } from "./shapes.ts";

interface Part {
    /// Mean and standard deviation of the deviations.
    mean: number;
    deviation: number;
    /// Parts of the nominal and labels.
    parts: number;
    labels: number;
    seed: number;
    hasLimit?: boolean;
}

const bins = 41;
const tolerance: [number, number] = [-0.05, 0.1];
const [low, high] = [-0.1, 0.2];

const columns: [name: string, help: string][] = [
    ["points", "Points of the scan; of a mesh, its vertices in triangles."], ["in-tolerance", "Share of the counted points within the tolerance, ends included."],
    ["above", "Share of the counted points above the tolerance."], ["below", "Share of the counted points below the tolerance."],
    ["min", "Least deviation."], ["max", "Largest deviation."], ["mean", "Mean deviation."], ["rms", "Root of the mean squared deviation."],
    ["standard-deviation", "Root of the mean squared difference from the mean."], ["p1", "Least deviation that at least 1 % of all do not exceed."],
    ["p50", "Least deviation that at least 50 % of all do not exceed."], ["p99", "Least deviation that at least 99 % of all do not exceed."],
];

export function makeInspection(part: Part): Inspection {
    const next = random(part.seed);
    // The last part has no points.
    const rows = Array.from({ length: part.parts > 0 ? part.parts + 1 : 1 }, (_, index) => {
        if (index > 2 && index === part.parts) return { part: `part ${index + 1}`, texts: columns.map(([name]) => (name === "points" ? "0" : "")) };
        const mean = part.mean + (index === 0 ? 0 : 0.03 * (next() - 0.4));
        const [below, above] = [share((tolerance[0] - mean) / part.deviation), 1 - share((tolerance[1] - mean) / part.deviation)];
        return {
            part: index === 0 ? "whole nominal" : `part ${index + 1}`,
            texts: [
                String(index === 0 ? 103570 : Math.round(200 + 9000 * next())), percent(1 - above - below), percent(above), percent(below),
                length(mean - 3.9 * part.deviation), length(mean + 3.9 * part.deviation), length(mean), length(Math.hypot(mean, part.deviation)),
                length(part.deviation), length(mean - 2.3 * part.deviation), length(mean), length(mean + 2.3 * part.deviation),
            ],
        };
    });
    const labels = Array.from({ length: part.labels }, (_, index) => {
        const isBelow = next() < 0.3;
        const value = (isBelow ? part.mean - 3.9 * part.deviation : part.mean + 3.9 * part.deviation) * (1 - 0.015 * index);
        return { deviation: length(value), value, position: [60, 40, 20].map((size) => length(size * (next() - 0.5))) as [string, string, string] };
    }).sort((a, b) => Math.abs(b.value) - Math.abs(a.value));
    return {
        step: "inspect", unit: "mm", tolerance, histogram: histogramOf(part),
        expected: part.hasLimit === false ? [] : [{ name: "in-tolerance", limit: "at least 99 %", value: rows[0]!.texts[1]!, met: Number.parseFloat(rows[0]!.texts[1]!) >= 99 }],
        columns: columns.map(([name, help]) => ({ name, help })), rows, labels,
        facts: [
            { name: "aligned", text: "yes", help: "Whether a transform was given." }, { name: "alignment-rms", text: "0.01233 mm", help: "Distance that the alignment left, from the transform." },
            { name: "chord-error", text: "0.005 mm", help: "Largest distance of the nominal from the CAD surface, as given." }, { name: "max-distance", text: "1 mm", help: "Largest distance at which a point is counted." },
            { name: "counted", text: "103412", help: "Points in the statistics." }, { name: "too-far", text: "158", help: "Points left out because they are farther than max-distance." },
            { name: "undecided", text: "0", help: "Points left out because their sign is undecided." }, { name: "beyond-borders", text: "0", help: "Points left out because they are beyond the border." },
            { name: "cut", text: "0", help: "Points cut from the statistics by sigma." }, { name: "diagonal", text: "74.83 mm", help: "Diagonal of the bounding box of the nominal." },
        ],
    };
}

/// The values of a step that inspects, as cells list them.
export function inspectedValues(inspection: Inspection): Value[] {
    const value = (name: string, number: number | null, text: string): Value => ({ source: inspection.step, name, value: number, text, accepted: null });
    const numbered = (name: string, index: number) => (index === 0 ? name : `${name}@${index + 1}`);
    return [
        ...inspection.columns.map((column, index) => value(column.name, null, inspection.rows[0]!.texts[index]!)),
        ...inspection.rows.slice(1).map((row, index) => value(`mean@${index + 2}`, null, row.texts[6]!)),
        ...inspection.histogram!.shares.map((one, index) => value(numbered("histogram", index), one, String(one))),
        ...inspection.labels.flatMap((label, index) => [value(numbered("label", index), label.value, label.deviation), ...label.position.map((text, axis) => value(numbered(`label-${"xyz"[axis]}`, index), null, text))]),
    ];
}

function histogramOf(part: Part): Histogram {
    const edge = (index: number) => (index === 0 ? -Infinity : index === bins ? Infinity : low + ((high - low) * index) / bins);
    const shares = Array.from({ length: bins }, (_, index) => share((edge(index + 1) - part.mean) / part.deviation) - share((edge(index) - part.mean) / part.deviation));
    return { low, high, shares, tolerance };
}

/// The distribution function of the normal distribution, by its logistic approximation.
function share(z: number): number {
    return 1 / (1 + Math.exp(-1.5976 * z - 0.070566 * z ** 3));
}

function length(value: number): string {
    return `${Number(value.toPrecision(4))} mm`;
}

function percent(value: number): string {
    return `${Number((100 * value).toPrecision(4))} %`;
}

const sha = "9f2c4e1a".repeat(8);
const longDoubt = "the nominal's triangles face different sides at 128 edges, so that signs of deviations there may be wrong; ".repeat(9).trim();

function makeSheet(scan: string, inspection: Inspection | null, more: Partial<Sheet> = {}): Sheet {
    return {
        workflow: "inspect-aligned", scan, variant: "default", verdict: "new", outcome: "ok", reasons: [], doubts: [], known: null, warnings: [], error: "",
        facts: [
            ["scan", `${scan}, 2,485,802 bytes, sha256 ${sha}`], ["nominal", `cad/${scan.split("/").at(-1)!.replace(/\.ply$/, "")}.stl, 84,684 bytes, sha256 ${sha}`], ["unit", "mm"],
            ["inspect", "version 1, tolerance [-0.05 mm, 0.1 mm], by patches"], ["align", "version 2"], ["icp", "version 4, trim 0 %"],
            ["program", "Scanmill 1.5.0-dev (bdeee11)"], ["machine", "mill-3: 16 × AMD EPYC 7302P, 64 GB, Debian 12"], ["time", "2026-11-28 02:15 UTC, 1.94 s"],
        ],
        inspection, pictures: [{ image: "scan", caption: "Deviations of the scan" }, { image: "nominal", caption: "Mean deviations on the nominal" }], ...more,
    };
}

const failed = (found = bad(1).rows[0]!.texts[1]!): Partial<Sheet> => ({
    verdict: "failed", outcome: "failed", reasons: [`expected in-tolerance in [99 %, 100 %], found ${found}`],
    error: `error: expected in-tolerance in [99 %, 100 %], found ${found}\n  in step 'inspect' (inspect.yaml:12:5)`,
});

function makeSheets(batch: string, sheets: Sheet[], notes: string[] = []): SheetData {
    const [scan, nominal] = [torus(60, 0.05, 3), torus(60, 0.09, 4)];
    const scale = { low, high, tolerance };
    return {
        scanmill: 1, batch, folder: `out/${batch}`, notes, sheets,
        run: { id: 130, started: "2026-11-28T02:15:07Z", version: "1.5.0-dev", machine: "mill-3", threads: 4, jobs: 4, seconds: 64 },
        images: sheets.some((sheet) => sheet.pictures.length > 0) ? { scan: picture(scan, scale, 400, 300), nominal: picture(nominal, scale, 400, 300) } : {},
    };
}

const good = (seed: number, parts = 6, labels = 10) => makeInspection({ mean: 0.018, deviation: 0.0201, parts, labels, seed });
const bad = (seed: number, parts = 6, labels = 10) => makeInspection({ mean: 0.041, deviation: 0.0402, parts, labels, seed });
const noScan = { verdict: "failed", outcome: "failed", reasons: ["align failed"], error: "error: needs at least 3 points; 'points.csv' has 2\n  in step 'align' (inspect-aligned.yaml:14:5)", pictures: [] } satisfies Partial<Sheet>;

export const sheetSets: Record<string, () => SheetData> = {
    "sheet-one": () => makeSheets("brackets", [makeSheet("scans/bracket-01.ply", bad(1), failed())], ["1 picture was left out, because the page would be larger than 40 MB."]),
    "sheet-several": () => makeSheets("brackets", [
        makeSheet("scans/bracket-01.ply", good(1)),
        makeSheet("scans/we ird'<script>.ply", bad(2), failed()),
        makeSheet("scans/bracket-03.ply", null, noScan),
        makeSheet("scans/bracket-04.ply", good(4), { verdict: "doubtful", outcome: "doubtful", doubts: ["the nominal is inside out"], known: { who: "Ben", why: "the supplier exports it so", at: "2026-11-20T10:00:00Z" } }),
        makeSheet("scans/bracket-05.ply", makeInspection({ mean: 0.01, deviation: 0.02, parts: 0, labels: 4, seed: 5, hasLimit: false })),
        makeSheet("scans/bracket-06.ply", null, { verdict: "missing", outcome: "skipped", reasons: ["the run was interrupted before this cell"], pictures: [] }),
        makeSheet("scans/bracket-07.ply", good(7, 0), { pictures: [{ image: "scan", caption: "Deviations of the scan" }], warnings: ["inspect: chord-error 0.02 mm is more than a tenth of the tolerance's width"] }),
        makeSheet("scans/bracket-08.ply", good(8), { verdict: "regressed", reasons: ["rms is larger by more than +1 %"] }),
    ]),
    "sheet-hard": () => makeSheets(`a batch "with" <b>markup</b> & ${"long-name-".repeat(14)}`, [
        makeSheet("scans/we ird'<script>.ply", bad(1, 40, 20), { ...failed(), doubts: [longDoubt, longDoubt, longDoubt], warnings: [longDoubt] }),
        makeSheet(`scans/${"a-very-long-folder-name/".repeat(7)}we ird'<script>alert(1)</script>.ply`, bad(2, 40, 20), {
            ...failed(), variant: "tight-<i>variant</i>-".repeat(6), doubts: Array.from({ length: 25 }, (_, index) => `${index + 1}: ${longDoubt}`), warnings: Array.from({ length: 25 }, () => longDoubt),
            facts: Array.from({ length: 60 }, (_, index) => [`input-${index + 1}-<b>`, `scans/${"x".repeat(300)}.ply`] as [string, string]),
        }),
        makeSheet("scans/all-parts.ply", good(3, 100, 1000), { pictures: [{ image: "scan", caption: "Deviations of the scan" }] }),
        makeSheet("scans/none.ply", null, { ...noScan, error: `error: ${longDoubt}` }),
        makeSheet("scans/forty.ply", good(5, 40, 20)),
    ]),
    "sheet-bare": () => makeSheets("bare", [makeSheet("plate.ply", makeInspection({ mean: 0.01, deviation: 0.02, parts: 0, labels: 0, seed: 9, hasLimit: false }), { pictures: [], facts: [] })], ["2 pictures could not be read."]),
    "sheet-none": () => makeSheets("none", [makeSheet("plate.ply", null, { ...noScan })]),
    "sheet-many": () => makeSheets("nightly", Array.from({ length: 120 }, (_, index) => makeSheet(`scans/bracket-${index + 1}.ply`, index % 30 === 7 ? bad(index, 40, 20) : good(index, 40, 20), index % 30 === 7 ? failed() : {}))),
};
