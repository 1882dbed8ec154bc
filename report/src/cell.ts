// SPDX-License-Identifier: GPL-3.0-or-later
/// The details of a cell, for the dialog and for paper.

import { changeTable } from "./changes.ts";
import * as texts from "./cell_texts.ts";
import type { Cell } from "./data.ts";
import { element } from "./element.ts";
import type { Child } from "./element.ts";
import * as format from "./format.ts";
import { histogram } from "./histogram.ts";
import { inspectionDetails } from "./inspection.ts";
import { legend } from "./legend.ts";
import { addressOf, scanName } from "./names.ts";
import { resultPictures, scanPictures, strip } from "./pictures.ts";
import type { Report } from "./report.ts";
import { swipe } from "./swipe.ts";
import { badge, symbol } from "./verdict.ts";
import type { ViewedMesh } from "./views.ts";
import { waterfall } from "./waterfall.ts";

/// `views` are the views in 3D, null on paper.
export function cellDetails(report: Report, cell: Cell, views: HTMLElement | null): HTMLElement {
    const changes = report.changesOf(cell);
    const onPaper = views === null;
    return element("div", { class: "cell" },
        texts.findings(cell),
        cell.outcome === "failed" && part("End of the log", texts.log(cell)),
        cell.inspection && part("Inspection", inspectionDetails(cell.inspection)),
        part("Changes", changes.length > 0 && changeTable(changes, "Changes since the accepted run")),
        part("Pictures", ...pictures(report, cell, onPaper)),
        part("Deviations", ...deviations(report, cell)),
        views && part("In 3D", views),
        part("Values", ...texts.values(report, cell)),
        part("Steps", waterfall(cell)),
        part("Output files", texts.outputs(cell)),
        cell.outcome !== "failed" && part("End of the log", texts.log(cell)),
        part("To reproduce", texts.command(cell)));
}

/// The heading of a cell: scan, variant, verdict.
export function cellHeading(report: Report, cell: Cell): Child[] {
    return [scanName(cell.scan), " ", element("span", { class: "variant" }, report.title(cell)), " ", badge(cell.verdict)];
}

/// One line of what identifies the cell.
export function cellLine(cell: Cell): HTMLElement {
    return element("p", { class: "quiet" }, `${cell.workflow}, ${cell.outcome}, ${format.seconds(cell.seconds)}`);
}

/// Links to the other variants of the scan.
export function variantLinks(report: Report, cell: Cell): HTMLElement | null {
    const variants = report.variantsOf(cell);
    if (variants.length < 2) return null;
    return element("nav", { class: "variants", "aria-label": "Variants of this scan" }, variants.map((other) =>
        element("a", { href: addressOf(other), "aria-current": other === cell ? "page" : null }, symbol(other.verdict), " ", report.title(other))));
}

/// The meshes of all variants of the scan.
export function meshesOf(report: Report, cell: Cell): ViewedMesh[] {
    return report.variantsOf(cell).flatMap((other) => {
        const mesh = other.mesh === null ? undefined : report.data.meshes[other.mesh];
        return mesh ? [{ title: report.title(other), mesh, isCurrent: other === cell }] : [];
    });
}

function part(title: string, ...content: Child[]): HTMLElement | null {
    const filled = content.filter((child) => child);
    return filled.length > 0 ? element("section", { class: "part" }, element("h3", null, title), filled) : null;
}

function pictures(report: Report, cell: Cell, onPaper: boolean): Child[] {
    const ofScan = scanPictures(report, cell);
    const results = resultPictures(report, cell, "result");
    const maps = resultPictures(report, cell, "deviation");
    const all = [...ofScan, ...results];
    const swiped = [...all, ...maps];
    if (swiped.length === 0) return [];
    const own = swiped.findIndex((picture) => picture.cell === cell);
    const accepted = swiped.findIndex((picture) => picture.caption.endsWith("accepted run"));
    const [left, right] = own < 0 ? [0, 1] : [accepted >= 0 ? accepted : own === 0 ? 1 : 0, own];
    const hasTruth = ofScan.some((picture) => picture.caption === "Truth");
    return [
        !hasTruth && element("p", { class: "quiet" }, "This scan has no truth."),
        strip(all, cell),
        !onPaper && swiped.length > 1 && [element("h4", null, "Compare two pictures"), swipe(swiped, left, right)],
    ];
}

function deviations(report: Report, cell: Cell): Child[] {
    const scale = report.deviationScale(cell);
    const maps = resultPictures(report, cell, "deviation");
    const cells = report.variantsOf(cell).filter((other) => other.histogram !== null);
    if (!scale || (maps.length === 0 && cells.length === 0)) return [];
    const top = Math.max(...cells.flatMap((other) => other.histogram!.shares), 0);
    return [
        legend(scale, cell["deviation-unit"]),
        maps.length > 0 && strip(maps, cell),
        cells.length > 0 && element("div", { class: "histograms" }, cells.map((other) =>
            histogram(other.histogram!, other["deviation-unit"], report.title(other), top, other === cell))),
    ];
}
