// SPDX-License-Identifier: GPL-3.0-or-later
/// The dialog with the details of a cell. It follows the address: #cell-12 opens it.

import { cellDetails, cellHeading, cellLine, meshesOf, variantLinks } from "./cell.ts";
import type { Cell } from "./data.ts";
import { element, replaceChildren } from "./element.ts";
import type { Report } from "./report.ts";
import { views } from "./views.ts";
import type { Views } from "./views.ts";

export interface CellDialog {
    readonly root: HTMLDialogElement;
    open(cell: Cell): void;
    close(): void;
    /// The cell that is shown.
    shown(): Cell | null;
}

/// `closed` is called after the dialog was closed by the user.
export function cellDialog(report: Report, closed: () => void): CellDialog {
    const title = element("h2", { id: "cell-title", tabindex: -1 });
    const close = element("button", { type: "button", class: "close", "aria-label": "Close", onclick: () => root.close() }, "✕");
    const bar = element("header", { class: "cell-bar" }, title, close);
    const content = element("div", { class: "cell-content" });
    const root = element("dialog", { id: "cell", "aria-labelledby": "cell-title", onclose: () => onClose(), onclick: (event: MouseEvent) => { if (event.target === root) root.close(); } }, bar, content);
    let cell: Cell | null = null;
    let drawn: Views | null = null;
    let nearby: IntersectionObserver | null = null;
    let opener: string | null = null;

    function trendLink(of: Cell): HTMLElement | null {
        return report.trendsOf(of).length > 0 && report.data.runs.length > 1 ? element("p", null, element("a", { href: `#trend-${of.id}` }, "Trends of this scan")) : null;
    }

    function empty(): void {
        nearby?.disconnect();
        drawn?.dispose();
        drawn = null;
        content.replaceChildren();
    }

    function onClose(): void {
        empty();
        const last = cell;
        cell = null;
        closed();
        // The link that opened the dialog may have been drawn anew since.
        if (last && (document.activeElement === document.body || document.activeElement === null)) {
            document.querySelector<HTMLElement>(`main a[href="${opener ?? `#cell-${last.id}`}"]`)?.focus();
        }
    }

    return {
        root,
        open(next) {
            empty();
            cell = next;
            if (!root.open) opener = `#cell-${next.id}`;
            const place = element("div", { class: "views-wait" });
            const meshes = meshesOf(report, next);
            replaceChildren(title, cellHeading(report, next));
            replaceChildren(content, cellLine(next), trendLink(next), variantLinks(report, next), cellDetails(report, next, meshes.length > 0 ? place : element("p", { class: "quiet" }, "No mesh of this scan is in the page.")));
            if (!root.open) root.showModal();
            root.scrollTop = 0;
            title.focus();
            if (meshes.length === 0) return;
            // Drawing is slow without a GPU, so it waits until the reader comes near.
            nearby = new IntersectionObserver((entries) => {
                if (!entries.some((entry) => entry.isIntersecting)) return;
                nearby?.disconnect();
                drawn = views(meshes, report.deviationScale(next));
                place.replaceChildren(drawn.root);
            }, { root, rootMargin: "300px" });
            nearby.observe(place);
        },
        close() {
            if (root.open) root.close();
        },
        shown: () => cell,
    };
}
