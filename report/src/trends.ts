// SPDX-License-Identifier: GPL-3.0-or-later
/// A metric of a scan over the runs, with a line per variant.

import uPlot from "uplot";
import { element, replaceChildren, spoken } from "./element.ts";
import * as format from "./format.ts";
import type { Report, Row } from "./report.ts";
import type { Trend } from "./data.ts";

/// Colours of Okabe and Ito that are readable on white and on black; dashes and points differ too.
const colours = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8a7300", "#56b4e9", "#7a7a7a"];
const dashes = [[], [8, 4], [2, 3], [10, 3, 2, 3], [5, 5], [14, 4], [1, 5]];
const height = 320;
/// Fits on A4 and on Letter, in CSS pixels.
const sheetWidth = 660;

export interface Trends {
    readonly section: HTMLElement;
    /// Shows the trends of a scan.
    choose(scan: string): void;
    /// Draws again with the present colours, in the width of a sheet or of the screen.
    redraw(onPaper: boolean): void;
}

interface Line {
    title: string;
    trend: Trend;
}

export function trends(report: Report): Trends | null {
    const { data } = report;
    const rows = report.rows.filter((row) => row.cells.some((cell) => cell && report.trendsOf(cell).length > 0));
    if (rows.length === 0 || data.runs.length < 2) return null;
    const byScan = new Map(rows.map((row) => [row.scan, row]));
    const metrics = data.metrics.map((metric) => metric.name).filter((name) => data.trends.some((trend) => trend.metric === name));
    const initial = metrics.includes(data["default-metric"]) ? data["default-metric"] : metrics[0];

    const scanInput = element("input", { type: "text", list: "trend-scans", id: "trend-scan", autocomplete: "off", spellcheck: "false", onchange: () => draw(), onfocus: () => scanInput.select() });
    const scanList = element("datalist", { id: "trend-scans" }, rows.slice(0, 1000).map((row) => element("option", { value: row.scan })));
    const metricSelect = element("select", { id: "trend-metric", onchange: () => draw() }, metrics.map((name) => element("option", { value: name, selected: name === initial }, name)));
    const stage = element("div", { class: "trend-stage" });
    const note = element("p", { class: "quiet", role: "status" });
    const numbers = element("div", { class: "scroll tall", role: "region", "aria-label": "Numbers of the trend", tabindex: 0 });
    const details = element("details", null, element("summary", null, "Numbers"), numbers);
    let plot: uPlot | null = null;

    function draw(): void {
        const row = byScan.get(scanInput.value);
        if (!row) {
            replaceChildren(note, `No trend for “${scanInput.value}”.`);
            return;
        }
        const lines = linesOf(report, row, metricSelect.value);
        const accepted = data.runs.filter((run) => run.accepted).map((run) => run.id);
        replaceChildren(note, `${metricSelect.value} over ${format.counted(data.runs.length, "run")}. `,
            accepted.length > 0 ? `Triangles and dashed lines mark accepted runs: ${accepted.join(", ")}.` : "None of these runs was accepted.");
        plot?.destroy();
        stage.replaceChildren();
        plot = new uPlot(options(report, lines, stage.clientWidth || 800), [data.runs.map((_, index) => index), ...lines.map((line) => line.trend.values)], stage);
        plot.root.querySelector("canvas")?.setAttribute("aria-hidden", "true");
        fillNumbers(report, lines, numbers);
    }

    new ResizeObserver(() => {
        if (plot && !document.documentElement.classList.contains("paper") && stage.clientWidth > 0 && stage.clientWidth !== plot.width) plot.setSize({ width: stage.clientWidth, height });
    }).observe(stage);

    scanInput.value = (rows.find((row) => row.cells.some((cell) => cell?.verdict === "regressed")) ?? rows[0]!).scan;
    const section = element(
        "section",
        { id: "trends", "aria-labelledby": "trends-title" },
        element("h2", { id: "trends-title" }, "Trends"),
        element("div", { class: "controls" }, element("label", { class: "wide" }, "Scan ", scanInput), element("label", null, "Metric ", metricSelect)),
        scanList,
        note,
        element("figure", { "aria-label": "Chart of the trend; its numbers are in the table below" }, stage),
        details,
    );
    // The width of the chart is known after the first layout.
    requestAnimationFrame(draw);

    return {
        section,
        choose(scan) {
            scanInput.value = scan;
            draw();
            section.scrollIntoView();
            metricSelect.focus({ preventScroll: true });
        },
        redraw(onPaper) {
            plot?.setSize({ width: onPaper ? sheetWidth : stage.clientWidth, height });
        },
    };
}

function linesOf(report: Report, row: Row, metric: string): Line[] {
    const lines: Line[] = [];
    for (const cell of row.cells) {
        const trend = cell && report.trendsOf(cell).find((one) => one.metric === metric);
        if (trend) lines.push({ title: report.title(cell), trend });
    }
    return lines;
}

function options(report: Report, lines: Line[], width: number): uPlot.Options {
    const { runs } = report.data;
    const variable = (name: string) => () => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    const [ink, grid] = [variable("--quiet"), variable("--line")];
    const axis = { stroke: ink, grid: { stroke: grid, width: 1 }, ticks: { stroke: grid, width: 1 }, font: "12px system-ui, sans-serif" };
    const label = (index: number) => runs[index] ? `${runs[index].id}` : "";
    return {
        width,
        height,
        scales: { x: { time: false, range: () => [-0.5, runs.length - 0.5] } },
        legend: { live: true, markers: { width: 3 } },
        cursor: { points: { size: 8 } },
        axes: [
            { ...axis, label: "run", labelSize: 18, labelGap: -4, labelFont: axis.font, size: 32, space: 36, incrs: [1, 2, 5, 10, 20, 50, 100], values: (_plot, splits) => splits.map((split) => (Number.isInteger(split) ? label(split) : "")) },
            { ...axis, size: 64, values: (_plot, splits) => splits.map((split) => format.number(split)) },
        ],
        series: [
            { label: "run", value: (_plot, index) => (index === null || !runs[index] ? "–" : `${runs[index].id}, ${format.day(runs[index].started)}${runs[index].accepted ? ", accepted" : ""}`) },
            ...lines.map((line, index): uPlot.Series => ({
                label: line.title,
                stroke: colours[index % colours.length]!,
                width: 2,
                dash: dashes[index % dashes.length]!,
                points: { show: true, size: 5 },
                spanGaps: false,
                value: (_plot, value) => (value === null || value === undefined ? "–" : format.number(value)),
            })),
        ],
        hooks: { drawAxes: [(plot) => markAccepted(plot, runs.map((run) => run.accepted), ink())] },
    };
}

function markAccepted(plot: uPlot, accepted: boolean[], colour: string): void {
    const { ctx, bbox } = plot;
    const size = 5 * devicePixelRatio;
    ctx.save();
    ctx.strokeStyle = ctx.fillStyle = colour;
    ctx.setLineDash([3 * devicePixelRatio, 3 * devicePixelRatio]);
    accepted.forEach((isAccepted, index) => {
        if (!isAccepted) return;
        const x = Math.round(plot.valToPos(index, "x", true));
        ctx.beginPath();
        ctx.moveTo(x, bbox.top);
        ctx.lineTo(x, bbox.top + bbox.height);
        ctx.stroke();
        ctx.beginPath();
        ctx.moveTo(x - size, bbox.top);
        ctx.lineTo(x + size, bbox.top);
        ctx.lineTo(x, bbox.top + 1.6 * size);
        ctx.fill();
    });
    ctx.restore();
}

function fillNumbers(report: Report, lines: Line[], into: HTMLElement): void {
    const rows = report.data.runs.map((run, index) =>
        element("tr", null,
            element("th", { scope: "row" }, `${run.id}`, run.accepted && [" ▼", spoken(" accepted")]),
            element("td", null, format.day(run.started)), element("td", null, run.verdict),
            lines.map((line) => element("td", { class: "right" }, line.trend.values[index] === null || line.trend.values[index] === undefined ? "–" : format.number(line.trend.values[index])))));
    replaceChildren(into, element("table", { "aria-label": "Numbers of the trend" },
        element("thead", null, element("tr", null,
            ["Run", "Started", "Verdict"].map((name) => element("th", { scope: "col" }, name)),
            lines.map((line) => element("th", { scope: "col", class: "right" }, line.title)))),
        element("tbody", null, rows.reverse())));
}
