// SPDX-License-Identifier: GPL-3.0-or-later
/// Shows a long list in pages, with a sentence about what is shown and what is on the other pages.

import { element, replaceChildren } from "./element.ts";
import * as format from "./format.ts";

export interface Pages<Item> {
    /// The sentence and the buttons.
    readonly bar: HTMLElement;
    /// Shows the first page of other items.
    show(items: Item[]): void;
}

/// `render` draws a page; `rest` may say what the items on other pages are.
export function pages<Item>(
    noun: string,
    size: number,
    render: (shown: Item[]) => void,
    rest: (others: Item[]) => string = () => "",
): Pages<Item> {
    let items: Item[] = [];
    let first = 0;
    const text = element("p", { role: "status" });
    const previous = element("button", { type: "button", onclick: () => turn(-size) }, "Previous");
    const next = element("button", { type: "button", onclick: () => turn(size) }, "Next");
    const bar = element("div", { class: "pages" }, text, previous, next);

    function turn(by: number): void {
        first = Math.min(Math.max(first + by, 0), Math.max(0, Math.ceil(items.length / size) - 1) * size);
        const shown = items.slice(first, first + size);
        const hasOthers = items.length > size;
        bar.hidden = !hasOthers;
        previous.disabled = first === 0;
        next.disabled = first + size >= items.length;
        const others = hasOthers ? rest([...items.slice(0, first), ...items.slice(first + size)]) : "";
        const range = `${noun} ${format.count(first + 1)}–${format.count(first + shown.length)} of ${format.count(items.length)}.`;
        replaceChildren(text, hasOthers && range, hasOthers && others && ` ${others}`);
        render(shown);
    }

    return {
        bar,
        show(all) {
            items = all;
            first = 0;
            turn(0);
        },
    };
}
