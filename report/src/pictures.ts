// SPDX-License-Identifier: GPL-3.0-or-later
/// The pictures of a scan: its truth, the scan and the results of all variants, and their deviations.

import type { Cell } from "./data.ts";
import { element } from "./element.ts";
import type { Report } from "./report.ts";
import { symbol } from "./verdict.ts";

export interface Picture {
    source: string;
    caption: string;
    alt: string;
    /// The cell that the picture is of; null for pictures of the scan.
    cell: Cell | null;
}

/// The truth and the scan, which all variants share.
export function scanPictures(report: Report, cell: Cell): Picture[] {
    const found: Picture[] = [];
    for (const kind of ["truth", "scan"] as const) {
        const source = report.variantsOf(cell).map((other) => report.image(other.pictures[kind])).find((one) => one !== undefined);
        const name = kind === "truth" ? "Truth" : "Scan";
        if (source) found.push({ source, caption: name, alt: `${name} of ${cell.scan}`, cell: null });
    }
    return found;
}

/// The results or the deviations of all variants, the accepted result of the cell after its own.
export function resultPictures(report: Report, cell: Cell, kind: "result" | "deviation"): Picture[] {
    const found: Picture[] = [];
    for (const other of report.variantsOf(cell)) {
        const title = report.title(other);
        const source = report.image(other.pictures[kind]);
        const what = kind === "result" ? "Result" : "Deviation map";
        if (source) found.push({ source, caption: title, alt: `${what} of ${cell.scan}, ${title}`, cell: other });
        const accepted = kind === "result" && other === cell ? report.image(cell.pictures.accepted) : undefined;
        if (accepted) found.push({ source: accepted, caption: `${title}, accepted run`, alt: `Result of the accepted run of ${cell.scan}, ${title}`, cell: null });
    }
    return found;
}

export function strip(pictures: Picture[], current: Cell): HTMLElement {
    return element("ul", { class: "strip" }, pictures.map((picture) =>
        element("li", { class: picture.cell === current ? "current" : null },
            element("figure", null,
                element("img", { src: picture.source, alt: picture.alt }),
                element("figcaption", null, picture.cell && [symbol(picture.cell.verdict), " "], picture.caption)))));
}
