// SPDX-License-Identifier: GPL-3.0-or-later
// Opens pages in headless Chromium, and records what they must not do: messages, errors and requests.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { chromium } from "playwright-core";

export const pages = new URL("./build/pages/", import.meta.url).href;

const flags = ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];

/// A remark of the driver that draws without a GPU, when the browser takes the pixels of a WebGL canvas. It is not the page's.
const driverRemark = /GL Driver Message \(OpenGL, Performance.*GPU stall due to ReadPixels/;

export function launch(...more) {
    return chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: [...flags, ...more] });
}

/// Opens a page of build/pages; `page.faults` lists what went wrong since.
export async function open(browser, name, { hash = "", width = 1400, height = 1000, ...options } = {}) {
    const page = await browser.newPage({ viewport: { width, height }, ...options });
    const address = `${pages}${name}.html`;
    page.faults = [];
    page.on("console", (message) => {
        if (!driverRemark.test(message.text())) page.faults.push(`console ${message.type()}: ${message.text()}`);
    });
    page.on("pageerror", (error) => page.faults.push(`error: ${error.message}`));
    page.on("request", (request) => {
        const to = request.url();
        if (to.split("#")[0] !== address && !to.startsWith("data:")) page.faults.push(`request: ${to}`);
    });
    await page.goto(address + hash);
    return page;
}

/// The shares of pixels of an element's screenshot that have a colour like blue, like red or like the background.
export async function colours(page, locator) {
    const shot = (await locator.screenshot()).toString("base64");
    return page.evaluate(async (data) => {
        const image = new Image();
        image.src = `data:image/png;base64,${data}`;
        await image.decode();
        const canvas = document.createElement("canvas");
        [canvas.width, canvas.height] = [image.width, image.height];
        const plane = canvas.getContext("2d", { willReadFrequently: true });
        plane.drawImage(image, 0, 0);
        const pixels = plane.getImageData(0, 0, image.width, image.height).data;
        const background = pixels.slice(4 * (image.width * 8 + 8), 4 * (image.width * 8 + 8) + 3);
        let [drawn, blue, red] = [0, 0, 0];
        for (let at = 0; at < pixels.length; at += 4) {
            const [r, g, b] = pixels.slice(at, at + 3);
            if (Math.abs(r - background[0]) + Math.abs(g - background[1]) + Math.abs(b - background[2]) > 12) ++drawn;
            if (b > r + 40) ++blue;
            if (r > b + 40) ++red;
        }
        const all = pixels.length / 4;
        return { drawn: drawn / all, blue: blue / all, red: red / all };
    }, shot);
}

/// The data in a page of build/pages.
export function readData(name) {
    return JSON.parse(/<script type="application\/json" id="data">(.*?)<\/script>/s.exec(readFileSync(new URL(`${name}.html`, pages), "utf8"))[1]);
}

/// A test that opens a page, runs the body, and asserts that nothing was reported or requested meanwhile.
export function browserTestsOf(browser) {
    return (title, name, options, body) =>
        test(title, async () => {
            const page = await open(browser(), name, options);
            try {
                await body(page);
                assert.deepEqual(page.faults, []);
            } finally {
                await page.close();
            }
        });
}
