// SPDX-License-Identifier: GPL-3.0-or-later
/// Makes elements. Data reach the document only as text and as values of attributes, never as markup.

export type Child = Node | string | number | null | undefined | false | Child[];

type Listener = (event: never) => void;

/// `on…` adds a listener, `style` sets properties; `false` and `null` leave an attribute out, `true` sets it empty.
export interface Attributes {
    style?: Record<string, string>;
    [name: string]: string | number | boolean | null | undefined | Listener | Record<string, string>;
}

export function element<Name extends keyof HTMLElementTagNameMap>(
    name: Name,
    attributes: Attributes | null = null,
    ...children: Child[]
): HTMLElementTagNameMap[Name] {
    return fill(document.createElement(name), attributes, children);
}

export function svgElement<Name extends keyof SVGElementTagNameMap>(
    name: Name,
    attributes: Attributes | null = null,
    ...children: Child[]
): SVGElementTagNameMap[Name] {
    return fill(document.createElementNS("http://www.w3.org/2000/svg", name), attributes, children);
}

/// Replaces everything in an element.
export function replaceChildren(parent: Element, ...children: Child[]): void {
    parent.replaceChildren();
    append(parent, children);
}

/// Text for screen readers only.
export function spoken(text: string): HTMLElement {
    return element("span", { class: "spoken" }, text);
}

function fill<E extends HTMLElement | SVGElement>(made: E, attributes: Attributes | null, children: Child[]): E {
    for (const [name, value] of Object.entries(attributes ?? {})) {
        if (value === null || value === undefined || value === false) continue;
        if (typeof value === "function") made.addEventListener(name.slice(2), value as unknown as EventListener);
        else if (typeof value === "object") {
            for (const [property, text] of Object.entries(value)) made.style.setProperty(property, text);
        } else made.setAttribute(name, value === true ? "" : String(value));
    }
    append(made, children);
    return made;
}

function append(parent: Element, children: Child[]): void {
    for (const child of children) {
        if (child === null || child === undefined || child === false) continue;
        if (Array.isArray(child)) append(parent, child);
        else parent.append(child instanceof Node ? child : String(child));
    }
}
