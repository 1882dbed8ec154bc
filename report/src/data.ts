// SPDX-License-Identifier: GPL-3.0-or-later
/// The data of a report page, as the program writes it: JSON in the element `data`.
///
/// Times are ISO 8601 in UTC, seconds are elapsed seconds unless the name says `cpu-seconds`, memory is in bytes.
/// `text`, `accepted`, `found`, `change` and the medians are texts for people: they have the unit already.

export type Verdict = "failed" | "missing" | "regressed" | "doubtful" | "improved" | "new" | "passed";

export interface ReportData {
    scanmill: 1;
    batch: string;
    verdict: Verdict;
    folder: string;
    counts: Partial<Record<Verdict, number>>;
    run: Run;
    accepted: Run | null;
    acceptance: Statement | null;
    /// Version, machine, gate, changed filters, notes: name and text.
    facts: [string, string][];
    "default-metric": string;
    /// Every name that a value of a cell has, and `seconds`, `cpu-seconds`, `memory`.
    metrics: MetricInfo[];
    rules: RuleSummary[];
    /// All cells, or in a large run those with the worst verdicts; `counts` counts all.
    cells: Cell[];
    /// Sorted by effect, size and confidence.
    changes: Change[];
    /// The runs of the trends, oldest first.
    runs: { id: number; started: string; accepted: boolean; verdict: string }[];
    /// One value per entry of `runs`.
    trends: Trend[];
    /// Pictures by key: data:image/png;base64,…
    images: Record<string, string>;
    meshes: Record<string, Mesh>;
    /// Sentences such as "3 views in 3D were left out, because the page would be larger than 15 MB".
    notes: string[];
}

/// Who decided something, why and when.
export interface Statement {
    who: string;
    why: string;
    at: string;
}

export interface Run {
    id: number;
    started: string;
    version: string;
    machine: string;
    threads: number;
    jobs: number;
    seconds: number;
}

export interface MetricInfo {
    name: string;
    unit: string;
    better: "smaller" | "larger" | null;
}

export interface RuleSummary {
    metric: string;
    rule: string;
    variant: string;
    cells: number;
    median: string;
    "median-change": string;
    regressed: number;
}

export interface Cell {
    id: number;
    workflow: string;
    scan: string;
    variant: string;
    verdict: Verdict;
    outcome: string;
    seconds: number;
    reasons: string[];
    causes: string[];
    doubts: string[];
    warnings: string[];
    /// Set if the doubts were acknowledged.
    known: Statement | null;
    command: string;
    error: string;
    log: string;
    /// If several values have the same name, the first is the cell's value in the matrix.
    values: Value[];
    steps: Step[];
    outputs: { file: string; bytes: number; sha256: string }[];
    /// Keys of `images`. `accepted` is the result of the accepted run.
    pictures: Pictures;
    /// A key of `meshes`.
    mesh: string | null;
    "deviation-unit": string;
    histogram: Histogram | null;
    /// Set if a step of the cell inspected a part.
    inspection: Inspection | null;
}

/// What a step that compares a part with its nominal found. Texts have their units.
export interface Inspection {
    step: string;
    /// Unit of lengths.
    unit: string;
    tolerance: [number, number];
    /// Of all counted points, over the range of the heat map's colours.
    histogram: Histogram | null;
    /// What the workflow expects of the step. Empty: it sets no limit, so that a passed cell says nothing about the part.
    expected: Limit[];
    columns: { name: string; help: string }[];
    /// The whole nominal first, then its parts by number. One text per column; empty: a part without points.
    rows: { part: string; texts: string[] }[];
    /// The points that deviate most, the largest deviation first.
    labels: { deviation: string; value: number; position: [string, string, string] }[];
    /// The step's other numbers, such as alignment, chord error and points that do not count.
    facts: { name: string; text: string; help: string }[];
}

/// A condition on a metric or property: { name: "in-tolerance", limit: "at least 99 %", value: "82.02 %", met: false }.
export interface Limit {
    name: string;
    limit: string;
    /// Empty: the step has no such number.
    value: string;
    met: boolean;
}

/// The data of inspection sheets: one page per part and, for several parts, a first page with the verdicts.
export interface SheetData {
    scanmill: 1;
    batch: string;
    folder: string;
    run: Run;
    sheets: Sheet[];
    images: Record<string, string>;
    notes: string[];
}

/// A part. Without `inspection` no step inspected it, and `error` or `reasons` say why.
export interface Sheet {
    workflow: string;
    scan: string;
    variant: string;
    verdict: Verdict;
    outcome: string;
    reasons: string[];
    doubts: string[];
    known: Statement | null;
    warnings: string[];
    error: string;
    /// Files, filters with versions, program, machine, times: name and text.
    facts: [string, string][];
    inspection: Inspection | null;
    /// At most two heat maps. `image` is a key of `images`.
    pictures: { image: string; caption: string }[];
}

export interface Value {
    source: string;
    name: string;
    value: number | null;
    text: string;
    accepted: string | null;
}

export interface Step {
    label: string;
    filter: string;
    version: number;
    seconds: number;
    "cpu-seconds": number;
    memory: number;
    /// `ran`, `cached` or `same inputs`.
    origin: string;
    outcome: string;
    parameters: [string, string][];
}

export interface Pictures {
    truth?: string;
    scan?: string;
    result?: string;
    deviation?: string;
    accepted?: string;
}

/// Shares of the deviations in bins of equal width between `low` and `high`.
///
/// `low`, `high` and `tolerance` are also the colour scale of the deviation picture and of the view in 3D. They are the
/// same for all cells of a scan, so that variants can be compared by colour.
export interface Histogram {
    low: number;
    high: number;
    shares: number[];
    tolerance: [number, number] | null;
}

export interface Change {
    cell: number;
    what: string;
    accepted: string;
    found: string;
    change: string;
    share: number | null;
    rule: string;
    effect: "regression" | "improvement" | "listed";
}

export interface Trend {
    cell: number;
    metric: string;
    values: (number | null)[];
}

/// A triangle mesh with quantised vertices. Integers are little-endian.
export interface Mesh {
    /// The box of the vertices, in the unit of the scan.
    low: [number, number, number];
    high: [number, number, number];
    /// Base64 of u16 × 3 per vertex: 0 is `low`, 65535 is `high`.
    positions: string;
    /// Base64 of u16 × 3 per triangle, or of u32 × 3 if there are more than 65535 vertices.
    triangles: string;
    vertices: number;
    /// Base64 of u16 per vertex: 0 is `deviation-low`, 65534 is `deviation-high`, 65535 is no deviation.
    deviation: string | null;
    "deviation-low": number;
    "deviation-high": number;
}
