// SPDX-License-Identifier: GPL-3.0-or-later
/// Names of scans and links to cells.

import type { Cell } from "./data.ts";
import { element } from "./element.ts";
import { splitPath } from "./report.ts";

/// The path of a scan with its folder set back.
export function scanName(path: string): HTMLElement {
    const [folder, name] = splitPath(path);
    return element("span", { class: "path" }, folder && element("span", { class: "folder" }, folder), name);
}

export function addressOf(cell: Cell): string {
    return `#cell-${cell.id}`;
}
