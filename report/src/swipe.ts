// SPDX-License-Identifier: GPL-3.0-or-later
/// Two pictures above each other with a movable edge between them.

import { element } from "./element.ts";
import type { Picture } from "./pictures.ts";

/// Pre: at least two pictures.
export function swipe(pictures: Picture[], left: number, right: number): HTMLElement {
    const below = element("img", { alt: "", class: "swipe-right" });
    const above = element("img", { alt: "", class: "swipe-left" });
    const edge = element("div", { class: "swipe-edge", "aria-hidden": "true" });
    const stage = element("div", { class: "swipe-stage" }, below, above, edge);
    const leftSelect = choice("Left", left);
    const rightSelect = choice("Right", right);
    const range = element("input", { type: "range", min: 0, max: 100, step: 1, value: 50, class: "swipe-range", "aria-label": "Edge between the two pictures", oninput: () => move() });

    function choice(name: string, initial: number): HTMLSelectElement {
        return element("select", { "aria-label": `${name} picture`, onchange: () => load() },
            pictures.map((picture, index) => element("option", { value: index, selected: index === initial }, picture.alt.includes("Deviation") ? `${picture.caption}, deviation` : picture.caption)));
    }

    function load(): void {
        const [one, other] = [pictures[Number(leftSelect.value)]!, pictures[Number(rightSelect.value)]!];
        above.src = one.source;
        above.alt = one.alt;
        below.src = other.source;
        below.alt = other.alt;
        move();
    }

    function move(): void {
        stage.style.setProperty("--edge", `${range.value}%`);
        range.setAttribute("aria-valuetext", `${range.value} % of the width shows the left picture`);
    }

    function drag(event: PointerEvent): void {
        if (event.buttons === 0) return;
        const box = stage.getBoundingClientRect();
        range.value = String(Math.round((100 * (event.clientX - box.left)) / box.width));
        move();
    }
    stage.addEventListener("pointerdown", drag);
    stage.addEventListener("pointermove", drag);

    load();
    return element("div", { class: "swipe screen-only" },
        element("div", { class: "swipe-choice" }, leftSelect, rightSelect), stage, range);
}
