// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the built page in a browser, with the pages that make_data wrote.
import assert from "node:assert/strict";
import { readFileSync, statSync } from "node:fs";
import { after, before, describe, test } from "node:test";
import { browserTestsOf, colours, launch, open, pages, readData } from "./browser.mjs";

let browser;
before(async () => void (browser = await launch()));
after(() => browser.close());
const browserTest = browserTestsOf(() => browser);

const sources = ["nightly", "small", "first", "one", "none", "inspected", "many", "empty"];

const scans = (page) => page.locator("#matrix .scroll tbody th").allTextContents();
const isAtMost = async (page, limit) => assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= limit);

async function print(page) {
    await page.emulateMedia({ media: "print" });
    await page.locator(":root.paper").waitFor();
}

describe("the file", () => {
    test("Page_Built_HasNoFrameAndNoRemoteAddress", () => {
        const html = readFileSync(new URL("empty.html", pages), "utf8");
        const markup = html.replace(/<(script|style)([^>]*)>.*?<\/\1>/gs, "<$1$2>");
        assert.doesNotMatch(markup, /<iframe|<link[^>]+href="(?!data:)|<[^>]+src=|https?:/i);
        assert.doesNotMatch(/<style>(.*?)<\/style>/s.exec(html)[1], /@import|url\((?!data:)/);
        assert.match(html, /default-src 'none'/);
        assert.ok(statSync(new URL("empty.html", pages)).size < 1_000_000);
    });
    for (const name of sources) {
        browserTest(`Page_Opened_ReportsAndRequestsNothing: ${name}`, name, {}, async (page) => {
            await page.waitForTimeout(300);
            assert.equal(await page.locator("h1").count(), 1);
            await isAtMost(page, 1400);
        });
    }
});

describe("the first screen", () => {
    browserTest("Summary_Regressed_SaysSoInWords", "small", {}, async (page) => {
        const text = await page.locator("#summary").innerText();
        assert.match(text, /4 of 84 cells are worse than in the accepted run 118/);
        assert.match(text, /Also 2 failed, 1 missing, 3 doubtful\./);
        assert.match(text, /Accepted by Ann, 2026-11-16: looked at every mesh/);
        assert.match(text, /49 views in 3D were left out/);
        assert.match(await page.title(), /library: regressed/);
    });
    browserTest("Summary_NoAcceptedRun_SaysSo", "first", {}, async (page) => {
        assert.match(await page.locator("#summary").innerText(), /Accepted run\s+None/);
        assert.equal(await page.locator("#changes, #rules, #trends").count(), 0);
    });
    browserTest("Summary_NoCells_SaysSo", "none", {}, async (page) => {
        assert.match(await page.locator("#summary").innerText(), /The run has no cells/);
    });
    browserTest("Summary_CountChosen_FiltersMatrix", "small", {}, async (page) => {
        await page.locator(".tile.failed").click();
        assert.equal((await scans(page)).length, 2);
    });
});

describe("what changed", () => {
    browserTest("Changes_Regressions_ComeFirstWithBothPictures", "small", {}, async (page) => {
        assert.match(await page.locator("#changes h3").first().innerText(), /Regressions/);
        const first = page.locator("#changes .changes > li").first();
        assert.equal(await first.locator("img").count(), 2);
        assert.match(await first.innerText(), /bin-size 2 %diag → 3 %diag/);
        assert.ok(await first.locator("img").first().evaluate((image) => image.complete && image.naturalWidth > 0));
    });
    browserTest("Changes_HostileName_IsShownAsText", "small", {}, async (page) => {
        assert.ok((await page.locator("#changes").innerText()).includes("we ird'<script>.ply"));
    });
});

describe("the matrix", () => {
    browserTest("Matrix_SortedByName_IsOrderedAndSaysSo", "small", {}, async (page) => {
        const header = page.locator("#matrix .scroll thead th").first();
        await header.locator("button").click();
        assert.equal(await header.getAttribute("aria-sort"), "ascending");
        const names = await scans(page);
        assert.deepEqual(names, [...names].sort(new Intl.Collator("en", { numeric: true }).compare));
        await header.locator("button").click();
        assert.equal(await header.getAttribute("aria-sort"), "descending");
        assert.deepEqual(await scans(page), names.reverse());
        assert.equal(await page.evaluate(() => document.activeElement.dataset.column), "name");
    });
    browserTest("Matrix_SortedByVariant_OrdersEachUnitWithMissingValuesLast", "small", {}, async (page) => {
        await page.locator("#matrix .sort[data-column='2']").click();
        const texts = await page.locator("#matrix .scroll tbody tr td:nth-child(4) .reading").allTextContents();
        const known = texts.filter((text) => /\d/.test(text));
        assert.ok(known.length > 8 && known.length < texts.length);
        assert.deepEqual(texts.slice(0, known.length), known);
        const millimetres = known.filter((text) => text.endsWith("mm")).map(parseFloat);
        assert.deepEqual(millimetres, [...millimetres].sort((a, b) => b - a));
        assert.equal(await page.locator("#matrix .scroll th[aria-sort='descending']").count(), 1);
    });
    browserTest("Matrix_FilteredByText_SaysWhichTroublesAreHidden", "small", {}, async (page) => {
        await page.getByLabel("Scan", { exact: true }).first().fill("<script>");
        assert.deepEqual(await scans(page), ["scans/we ird'<script>.ply"]);
        assert.match(await page.locator("#matrix .status").innerText(), /1 scan of 14 shown\. Hidden: 2 failed, 1 missing, 3 regressed, 3 doubtful/);
        await page.getByRole("button", { name: "Show all scans" }).click();
        assert.equal((await scans(page)).length, 14);
        assert.equal(await page.locator("#matrix .status").innerText(), "");
    });
    browserTest("Matrix_FilteredByVerdict_ShowsScansWithSuchACell", "small", {}, async (page) => {
        await page.locator("#matrix .toggle.missing").click();
        assert.deepEqual(await scans(page), ["scans/nightly/bracket-13.ply"]);
        assert.equal(await page.locator("#matrix .toggle.missing").getAttribute("aria-pressed"), "true");
    });
    browserTest("Matrix_Coloured_ByValueWithinScanOrUnit", "small", {}, async (page) => {
        const row = page.locator("#matrix .scroll tbody tr").first();
        const shares = await row.locator("td").evaluateAll((cells) => cells.map((cell) => Number(cell.style.getPropertyValue("--share"))));
        assert.equal(Math.min(...shares), 0);
        assert.equal(Math.max(...shares), 1);
        await page.locator("#matrix-scope").selectOption("all");
        assert.match(await page.locator(".matrix-legend").innerText(), /Values in mm and in u have ranges of their own/);
        await page.locator("#matrix-metric").selectOption("f-score");
        const best = await row.locator("td").first().evaluate((cell) => Number(cell.style.getPropertyValue("--share")));
        const worst = await row.locator("td").last().evaluate((cell) => Number(cell.style.getPropertyValue("--share")));
        assert.ok(best < worst, "the larger f-score is better and lighter");
    });
    browserTest("Matrix_Verdicts_HaveSymbolsAndWords", "small", {}, async (page) => {
        const cell = page.locator("#matrix .scroll td.failed a").first();
        assert.match(await cell.textContent(), /✕failed: /);
        assert.equal(await page.locator("#matrix .scroll td.doubtful .known").count(), readData("small").cells.filter((one) => one.verdict === "doubtful" && one.known).length);
    });
    browserTest("Matrix_TenThousandCells_AreShownInPages", "many", {}, async (page) => {
        assert.equal((await scans(page)).length, 200);
        const bar = page.locator("#matrix .pages");
        assert.match(await bar.innerText(), /Scans 1–200 of 1,250\. On other pages: 87 regressed, 94 doubtful/);
        await bar.getByRole("button", { name: "Next" }).click();
        assert.match(await bar.innerText(), /Scans 201–400 of 1,250/);
        // Less than a second on an idle machine; the limit is for a busy one.
        const time = await page.evaluate(() => {
            const start = performance.now();
            document.querySelector("#matrix .sort[data-column='5']").click();
            document.querySelector("#matrix .scroll").getBoundingClientRect();
            return performance.now() - start;
        });
        assert.ok(time < 4000, `${time} ms`);
        await page.getByLabel("Scan", { exact: true }).first().fill("torus");
        assert.equal((await scans(page)).length, 200);
    });
});

describe("a cell", () => {
    browserTest("Cell_OpenedFromMatrix_ShowsItsParts", "small", {}, async (page) => {
        await page.locator("#matrix .scroll tbody tr").nth(1).locator("td a").first().click();
        await page.locator("dialog[open]").waitFor();
        assert.match(page.url(), /#cell-7$/);
        const headings = await page.locator("dialog h3").allTextContents();
        for (const name of ["Reasons", "Causes", "Changes", "Pictures", "Deviations", "In 3D", "Values", "Steps", "Output files", "To reproduce"]) assert.ok(headings.includes(name), name);
        assert.ok((await page.locator("dialog h2").innerText()).includes("we ird'<script>.ply"));
        assert.ok((await page.locator("dialog .command code").innerText()).includes("'scans/we ird'\\''<script>.ply'"));
        assert.equal(await page.locator("dialog .histogram").count(), 6);
        assert.equal(await page.locator("dialog img:not([alt])").count(), 0);
    });
    browserTest("Cell_Escape_ClosesAndReturnsFocus", "small", {}, async (page) => {
        const link = page.locator("#matrix .scroll tbody tr").nth(2).locator("td a").nth(1);
        await link.focus();
        await page.keyboard.press("Enter");
        await page.locator("dialog[open]").waitFor();
        assert.equal(await page.evaluate(() => document.activeElement.id), "cell-title");
        await page.keyboard.press("Tab");
        assert.equal(await page.evaluate(() => document.activeElement.getAttribute("aria-label")), "Close");
        for (let press = 0; press < 80; ++press) {
            await page.keyboard.press("Tab");
            assert.ok(await page.evaluate(() => document.activeElement === document.body || document.activeElement.closest("dialog") !== null), "focus stays in the dialog");
        }
        await page.keyboard.press("Escape");
        await page.locator("dialog[open]").waitFor({ state: "detached" });
        await page.waitForFunction(() => location.hash === "");
        assert.ok(await link.evaluate((element) => element === document.activeElement));
        assert.equal(await page.locator("dialog .views-canvas").count(), 0);
    });
    browserTest("Cell_Address_OpensIt", "small", { hash: "#cell-16" }, async (page) => {
        assert.match(await page.locator("dialog .finding.failed").innerText(), /needs at least 4 points/);
        assert.match(await page.locator("dialog .log").innerText(), /ball 40 of 40, 4407 cells <tested>/);
        await page.goBack();
        assert.equal(await page.locator("dialog[open]").count(), 0);
    });
    browserTest("Cell_KnownDoubt_IsMarked", "small", { hash: "#cell-20" }, async (page) => {
        assert.match(await page.locator("dialog .finding.doubtful").innerText(), /Known\. Acknowledged by Ben, 2026-11-20: the scanner does not see the bore/);
    });
    browserTest("Cell_UnknownDoubt_IsNotMarked", "small", { hash: "#cell-19" }, async (page) => {
        assert.doesNotMatch(await page.locator("dialog .finding.doubtful").innerText(), /Known/);
    });
    browserTest("Cell_NoTruth_SaysSo", "small", { hash: "#cell-25" }, async (page) => {
        assert.match(await page.locator("dialog").innerText(), /This scan has no truth/);
        assert.equal(await page.locator("dialog .legend").count(), 0);
    });
    browserTest("Swipe_Keyboard_MovesTheEdge", "small", { hash: "#cell-7" }, async (page) => {
        const range = page.locator("dialog .swipe-range");
        const clip = () => page.locator("dialog .swipe-left").evaluate((image) => getComputedStyle(image).clipPath);
        const before = await clip();
        await range.focus();
        await page.keyboard.press("ArrowRight");
        await page.keyboard.press("ArrowRight");
        assert.notEqual(await clip(), before);
        assert.match(await range.getAttribute("aria-valuetext"), /^52 %/);
        const source = await page.locator("dialog .swipe-left").getAttribute("src");
        await page.getByLabel("Left picture").selectOption({ label: "Truth" });
        assert.notEqual(await page.locator("dialog .swipe-left").getAttribute("src"), source);
        assert.equal(await page.locator("dialog .swipe-left").getAttribute("alt"), "Truth of scans/we ird'<script>.ply");
    });
    browserTest("Copy_Pressed_CopiesTheCommand", "small", { hash: "#cell-7" }, async (page) => {
        await page.getByRole("button", { name: "Copy" }).click();
        await page.locator("dialog .command [role='status']:not(:empty)").waitFor();
        assert.match(await page.locator("dialog .command [role='status']").innerText(), /Copied|Selected/);
    });
    browserTest("Cell_TrendLink_ClosesAndShowsTheScan", "small", { hash: "#cell-7" }, async (page) => {
        await page.getByRole("link", { name: "Trends of this scan" }).click();
        assert.equal(await page.locator("dialog[open]").count(), 0);
        assert.equal(await page.locator("#trend-scan").inputValue(), "scans/we ird'<script>.ply");
    });
});

describe("the views in 3D", () => {
    browserTest("Views_Opened_AreDrawnInTheLegendsColours", "small", { hash: "#cell-12", height: 1400 }, async (page) => {
        await page.locator("dialog .views-wait").scrollIntoViewIfNeeded();
        const view = page.locator("dialog .view").last();
        await page.locator("dialog .view[data-camera]").last().waitFor();
        await view.scrollIntoViewIfNeeded();
        await page.waitForTimeout(200);
        const found = await colours(page, view);
        assert.ok(found.drawn > 0.1 && found.drawn < 0.9, `drawn ${found.drawn}`);
        assert.ok(found.blue > 0.01 && found.red > 0.01, JSON.stringify(found));
        assert.equal(await page.locator("dialog .view").count(), 6);
    });
    browserTest("Views_OneTurned_TurnsTheOthers", "small", { hash: "#cell-7", height: 1400 }, async (page) => {
        await page.locator("dialog .views-wait").scrollIntoViewIfNeeded();
        await page.locator("dialog .view[data-camera]").nth(1).waitFor();
        const cameras = () => page.locator("dialog .view").evaluateAll((views) => views.map((view) => view.dataset.camera));
        const before = await cameras();
        assert.equal(new Set(before).size, 1);
        const first = page.locator("dialog .view").first();
        await first.scrollIntoViewIfNeeded();
        const box = await first.boundingBox();
        await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
        await page.mouse.down();
        await page.mouse.move(box.x + box.width / 2 + 60, box.y + box.height / 2 + 20, { steps: 4 });
        await page.mouse.up();
        await page.waitForTimeout(200);
        const dragged = await cameras();
        assert.notEqual(dragged[0], before[0]);
        assert.equal(new Set(dragged).size, 1);
        await page.locator("dialog .view").nth(2).focus();
        await page.keyboard.press("ArrowLeft");
        await page.waitForTimeout(200);
        const turned = await cameras();
        assert.notEqual(turned[0], dragged[0]);
        assert.equal(new Set(turned).size, 1);
    });
    test("Views_NoWebGL_SaySo", async () => {
        const plain = await launch("--disable-3d-apis");
        const page = await open(plain, "small", { hash: "#cell-7" });
        await page.locator("dialog .views-wait").scrollIntoViewIfNeeded();
        await page.getByText("The views in 3D need WebGL 2").waitFor();
        await plain.close();
    });
    browserTest("Views_NoMesh_SaySo", "small", { hash: "#cell-60" }, async (page) => {
        assert.match(await page.locator("dialog").innerText(), /No mesh of this scan is in the page/);
    });
});

describe("the trends", () => {
    browserTest("Trends_Drawn_WithALinePerVariant", "small", {}, async (page) => {
        const canvas = page.locator("#trends canvas");
        await canvas.scrollIntoViewIfNeeded();
        await page.waitForTimeout(200);
        const found = await colours(page, canvas);
        assert.ok(found.blue > 0.001 && found.red > 0.001, JSON.stringify(found));
        assert.equal(await page.locator("#trends .u-legend .u-series").count(), 7);
        assert.match(await page.locator("#trends").innerText(), /mark accepted runs: 104, 118/);
        await page.locator("#trends summary").click();
        assert.equal(await page.locator("#trends details tbody tr").count(), 30);
        assert.match(await page.locator("#trends details tbody tr").first().innerText(), /^130\s+2026-11-28/);
    });
    browserTest("Trends_OtherMetric_ShowsOtherNumbers", "small", {}, async (page) => {
        const first = page.locator("#trends details tbody td.right").first();
        const before = await first.textContent();
        await page.locator("#trend-metric").selectOption("triangles");
        assert.notEqual(await first.textContent(), before);
    });
});

describe("keyboard and structure", () => {
    browserTest("Focus_Tab_FollowsTheDocument", "one", {}, async (page) => {
        await page.keyboard.press("Tab");
        assert.match(await page.evaluate(() => document.activeElement.textContent), /Skip the navigation/);
        const order = [];
        for (let press = 0; press < 40; ++press) {
            await page.keyboard.press("Tab");
            if (await page.evaluate(() => document.activeElement === document.body)) break;
            order.push(await page.evaluate(() => [...document.querySelectorAll("*")].indexOf(document.activeElement)));
        }
        assert.ok(order.length > 10);
        assert.deepEqual(order, [...order].sort((a, b) => a - b));
    });
    for (const name of ["small", "first", "one", "none"]) {
        browserTest(`Links_Internal_LeadSomewhere: ${name}`, name, {}, async (page) => {
            const ids = new Set(readData(name).cells.map((cell) => `#cell-${cell.id}`));
            const links = await page.locator("a").evaluateAll((all) => [...new Set(all.map((link) => link.getAttribute("href")))]);
            for (const link of links) {
                assert.match(link, /^#/);
                assert.ok(ids.has(link) || (await page.locator(`[id="${link.slice(1)}"]`).count()) === 1, link);
            }
        });
    }
    browserTest("Structure_Page_HasLandmarksHeadingsAndUniqueIds", "small", {}, async (page) => {
        assert.equal(await page.getByRole("main").count(), 1);
        assert.equal(await page.getByRole("navigation").count(), 1);
        assert.equal(await page.getByRole("banner").count(), 1);
        assert.equal(await page.getByRole("contentinfo").count(), 1);
        const levels = await page.locator("main h1, main h2, main h3, main h4").evaluateAll((all) => all.map((heading) => Number(heading.tagName[1])));
        levels.forEach((level, index) => assert.ok(level <= (levels[index - 1] ?? 0) + 1, `heading ${index}`));
        const ids = await page.locator("[id]").evaluateAll((all) => all.map((element) => element.id));
        assert.equal(new Set(ids).size, ids.length);
        const unnamed = await page.locator("select, input").evaluateAll((all) => all.filter((control) => control.labels.length === 0 && !control.ariaLabel).length);
        assert.equal(unnamed, 0);
    });
});

describe("narrow screens and paper", () => {
    for (const name of ["small", "first", "one", "none", "many"]) {
        browserTest(`Width_400_DoesNotScroll: ${name}`, name, { width: 400, height: 800 }, async (page) => {
            await page.waitForTimeout(200);
            await isAtMost(page, 400);
        });
        browserTest(`Print_Sheet_ClipsNoTable: ${name}`, name, { width: 690, height: 1000 }, async (page) => {
            await print(page);
            await isAtMost(page, 690);
            const clipped = await page.locator(".scroll, table, pre, .trend-stage").evaluateAll((all) =>
                all.filter((element) => element.clientWidth > 0 && element.scrollWidth > element.clientWidth + 1).map((element) => `${element.className} ${element.scrollWidth} > ${element.clientWidth}`));
            assert.deepEqual(clipped, []);
        });
    }
    browserTest("Width_400_CellDoesNotScroll", "small", { width: 400, height: 800, hash: "#cell-7" }, async (page) => {
        await page.waitForTimeout(500);
        assert.ok(await page.locator("dialog").evaluate((dialog) => dialog.scrollWidth <= dialog.clientWidth));
    });
    browserTest("Print_Troubles_AreExpanded", "small", { width: 690 }, async (page) => {
        await print(page);
        const counts = readData("small").counts;
        assert.equal(await page.locator(".paper-cell").count(), counts.failed + counts.missing + counts.regressed + counts.doubtful);
        assert.match(await page.locator(".paper-cell").first().innerText(), /needs at least 4 points/);
        await page.emulateMedia({ media: "screen" });
        await page.locator(":root:not(.paper)").waitFor();
        assert.equal(await page.locator(".paper-cell").count(), 0);
    });
    browserTest("Print_OpenCell_IsTheOnlyOne", "small", { width: 690, hash: "#cell-7" }, async (page) => {
        await print(page);
        assert.equal(await page.locator(".paper-cell").count(), 1);
        assert.equal(await page.locator("#matrix").isVisible(), false);
    });
    browserTest("Dark_Preferred_IsDark", "small", { colorScheme: "dark" }, async (page) => {
        assert.equal(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), "rgb(21, 24, 28)");
    });
});

describe("speed", () => {
    // Processor time of the page's main thread: other programs on the machine hardly change it.
    for (const [name, limit] of [["nightly", 2], ["many", 5]]) {
        test(`Load_${name}_TakesLessThan${limit}Seconds`, async (context) => {
            const page = await browser.newPage({ viewport: { width: 1400, height: 1000 } });
            const protocol = await page.context().newCDPSession(page);
            await protocol.send("Performance.enable", { timeDomain: "threadTicks" });
            await page.goto(`${pages}${name}.html`);
            const { metrics } = await protocol.send("Performance.getMetrics");
            const processor = metrics.find((metric) => metric.name === "TaskDuration").value;
            const elapsed = await page.evaluate(() => performance.getEntriesByType("navigation")[0].loadEventEnd / 1000);
            await page.close();
            const size = statSync(new URL(`${name}.html`, pages)).size / 1e6;
            context.diagnostic(`${name}: ${size.toFixed(1)} MB, ${processor.toFixed(2)} s processor time, ${elapsed.toFixed(2)} s until loaded`);
            assert.ok(processor > 0.01 && processor < limit);
        });
    }
});
