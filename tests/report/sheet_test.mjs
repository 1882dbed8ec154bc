// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the inspection of cells and the built inspection sheet in a browser, with the pages that make_data wrote.
import assert from "node:assert/strict";
import { readFileSync, statSync } from "node:fs";
import { after, before, describe, test } from "node:test";
import { browserTestsOf, launch, open, pages, readData } from "./browser.mjs";

let browser;
before(async () => void (browser = await launch()));
after(() => browser.close());
const browserTest = browserTestsOf(() => browser);

const sheets = ["sheet-one", "sheet-several", "sheet-hard", "sheet-bare", "sheet-none", "sheet-many"];
const paper = { width: ((210 - 28) * 96) / 25.4, height: ((297 - 28) * 96) / 25.4 };
const part = (page, name) => page.locator("main > .sheet").filter({ has: page.locator("h2.name", { hasText: name }) });

async function pagesOfPdf(page) {
    const pdf = (await page.pdf({ preferCSSPageSize: true })).toString("latin1");
    const box = /\/MediaBox \[0 0 ([\d.]+) ([\d.]+)\]/.exec(pdf);
    assert.ok(Math.abs(box[1] - 595) < 1 && Math.abs(box[2] - 842) < 1, `${box[1]} x ${box[2]}`);
    return pdf.match(/\/Type \/Page\b(?!s)/g).length;
}

describe("the file of the sheet", () => {
    test("Sheet_Built_IsSmallAndHasNoRemoteAddress", () => {
        const html = readFileSync(new URL("sheet-empty.html", pages), "utf8");
        const markup = html.replace(/<(script|style)([^>]*)>.*?<\/\1>/gs, "<$1$2>");
        assert.doesNotMatch(markup, /<iframe|<link[^>]+href="(?!data:)|<[^>]+src=|https?:/i);
        assert.doesNotMatch(/<style>(.*?)<\/style>/s.exec(html)[1], /@import|url\((?!data:)/);
        assert.match(html, /default-src 'none'/);
        assert.ok(statSync(new URL("sheet-empty.html", pages)).size < 60_000);
    });
    for (const name of [...sheets, "sheet-empty"]) {
        browserTest(`Sheet_Opened_ReportsAndRequestsNothing: ${name}`, name, {}, async (page) => {
            assert.equal(await page.locator("h1").count(), 1);
            assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 1400);
            assert.equal(await page.locator("img:not([alt])").count(), 0);
            const ids = await page.locator("[id]").evaluateAll((all) => all.map((element) => element.id));
            assert.equal(new Set(ids).size, ids.length);
        });
        browserTest(`Sheet_Width400_DoesNotScroll: ${name}`, name, { width: 400, height: 800 }, async (page) => {
            assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 400);
            const clipped = await page.locator("main > .sheet *").evaluateAll((all) =>
                all.filter((element) => !element.closest(".scroll, .spoken, svg") && element.getBoundingClientRect().right > 400).map((element) => element.className));
            assert.deepEqual(clipped, []);
        });
    }
});

describe("paper", () => {
    for (const [name, parts] of [["sheet-one", 1], ["sheet-bare", 1], ["sheet-none", 1], ["sheet-several", 9], ["sheet-hard", 6]]) {
        browserTest(`Pdf_Printed_HasAPagePerPart: ${name}`, name, {}, async (page) => assert.equal(await pagesOfPdf(page), parts));
    }
    for (const name of sheets) {
        // Fitted on a narrow screen, too: the measure is the paper and not the screen.
        for (const width of [1400, 400]) {
            browserTest(`Print_Part_FitsOnA4: ${name}, ${width}`, name, { width }, async (page) => {
                await page.emulateMedia({ media: "print" });
                await page.setViewportSize({ width: Math.floor(paper.width), height: 1000 });
                const found = await page.locator("main > .sheet:not(.cover)").evaluateAll((all) => all.map((sheet) => ({ height: sheet.getBoundingClientRect().height, width: sheet.scrollWidth })));
                for (const one of found) assert.ok(one.height <= paper.height && one.width <= Math.ceil(paper.width), JSON.stringify(one));
                const wide = await page.locator(".scroll").evaluateAll((all) => all.filter((one) => one.scrollWidth > one.clientWidth + 1).map((one) => one.ariaLabel));
                assert.deepEqual(wide, []);
            });
        }
    }
    browserTest("Print_ManyRows_ShowsTheWorstAndSaysHowManyAreLeftOut", "sheet-hard", {}, async (page) => {
        const sheet = part(page, "forty.ply");
        const shown = await sheet.locator(".parts tbody tr").count();
        assert.ok(shown >= 8 && shown < 41, `${shown} rows`);
        assert.ok((await sheet.innerText()).includes(`least share in tolerance come first; ${41 - shown} other parts of 40 are left out.`));
        const { inspection } = readData("sheet-hard").sheets.find((one) => one.scan === "scans/forty.ply");
        const worst = inspection.rows.slice(1).filter((row) => row.texts[1] !== "").sort((a, b) => parseFloat(a.texts[1]) - parseFloat(b.texts[1]));
        assert.deepEqual(await sheet.locator(".parts tbody th").allTextContents(), ["whole nominal", ...worst.slice(0, shown - 1).map((row) => row.part)]);
        const labels = await sheet.locator(".labels tbody tr").count();
        assert.ok((await sheet.innerText()).includes(`${20 - labels} more are left out.`));
    });
    browserTest("Print_FewRows_ShowsAllInTheirOrder", "sheet-several", {}, async (page) => {
        const sheet = part(page, "bracket-01.ply");
        assert.deepEqual(await sheet.locator(".parts tbody th").allTextContents(), ["whole nominal", ...[2, 3, 4, 5, 6, 7].map((number) => `part ${number}`)]);
        assert.deepEqual([...new Set(await sheet.locator(".parts tbody tr").last().locator("td").allTextContents())], ["–"]);
    });
    browserTest("Print_LongTexts_AreShortenedAndSaySo", "sheet-hard", {}, async (page) => {
        const sheet = page.locator("main > .sheet", { hasText: "a-very-long-folder-name" }).last();
        const notes = await sheet.locator(".notes li").count();
        assert.match(await sheet.locator(".notes").innerText(), /… \(\d+ more characters\)/);
        assert.ok((await sheet.innerText()).includes(`${50 - notes} more are left out.`));
    });
    browserTest("Print_Screen_HasAButtonThatPaperLacks", "sheet-one", {}, async (page) => {
        await page.evaluate(() => (window.print = () => (document.title = "printed")));
        await page.getByRole("button", { name: "Print" }).click();
        assert.equal(await page.title(), "printed");
        await page.emulateMedia({ media: "print" });
        assert.equal(await page.getByRole("button", { name: "Print" }).isVisible(), false);
    });
});

describe("the first page", () => {
    browserTest("Cover_Several_ListsTheWorstFirstWithSymbolsAndWords", "sheet-several", {}, async (page) => {
        const verdicts = await page.locator(".cover-parts .word").allTextContents();
        assert.deepEqual(verdicts, ["✕ Failed", "✕ Failed", "∅ Not inspected", "▼ Regressed", "? Doubtful", "○ No limit set", "✓ Passed", "✓ Passed"]);
        const text = await page.locator(".cover").innerText();
        assert.match(text, /2 of 8 parts failed, 2 passed\. For 1 part the workflow sets no limit\./);
        assert.match(text, /in tolerance at least 99\s%/);
        assert.match(text, /needs at least 3 points; 'points\.csv' has 2/);
        assert.match(text, /the run was interrupted before this cell/);
        assert.match(await page.locator(".cover .counts").innerText(), /✕ 2 failed\s+∅ 1 not inspected/);
    });
    browserTest("Cover_Links_LeadToTheirParts", "sheet-several", {}, async (page) => {
        const links = page.locator(".cover-parts a");
        assert.equal(await links.count(), 6);
        for (const link of await links.all()) {
            const name = await link.innerText();
            assert.ok((await page.locator(`${await link.getAttribute("href")} h2.name`).innerText()).includes(name.replace("scans/", "")));
        }
        await links.last().click();
        assert.ok((await part(page, "bracket-07.ply").boundingBox()).y < 200);
        await page.getByRole("link", { name: "All parts" }).click();
        assert.ok((await page.locator(".cover").boundingBox()).y >= 0);
    });
    browserTest("Cover_OnePart_IsLeftOut", "sheet-one", {}, async (page) => assert.equal(await page.locator(".cover").count(), 0));
    browserTest("Cover_LongTable_RepeatsItsHeading", "sheet-many", {}, async (page) => {
        await page.emulateMedia({ media: "print" });
        assert.equal(await page.locator(".cover-parts thead").evaluate((head) => getComputedStyle(head).display), "table-header-group");
        assert.equal(await page.locator(".cover-parts tbody tr").count(), 120);
    });
});

describe("the page of a part", () => {
    browserTest("Part_Failed_SaysTheLimitAndWhatWasFound", "sheet-one", {}, async (page) => {
        const text = await page.locator(".verdict").innerText();
        assert.match(text, /✕ Failed/);
        assert.match(text, /In tolerance 91\.7\s%; expected: at least 99\s%\./);
        assert.match(text, /Tolerance −0\.05 to \+0\.1 mm/);
        assert.doesNotMatch(text, /expected in-tolerance in|error:/);
        assert.match(await page.title(), /✕ brackets: inspection, failed/);
        assert.match(await page.locator(".sheet").innerText(), /2026-11-28 02:15 UTC[\s\S]*sha256 9f2c[\s\S]*Name[\s\S]*Date[\s\S]*Signature/);
    });
    browserTest("Part_NoExpectation_SaysSoAndIsNotPassed", "sheet-bare", {}, async (page) => {
        const text = await page.locator(".sheet").innerText();
        assert.match(text, /○ No limit set/);
        assert.match(text, /The workflow sets no limit for this part\./);
        assert.doesNotMatch(text, /Passed/);
    });
    browserTest("Part_NoPicturesAndLabels_SaySo", "sheet-bare", {}, async (page) => {
        assert.match(await page.locator(".sheet").innerText(), /This part has no pictures\.[\s\S]*The step labels no points\.[\s\S]*2 pictures could not be read\./);
        assert.equal(await page.locator("img, .parts, .files").count(), 0);
    });
    browserTest("Part_NotInspected_SaysWhy", "sheet-none", {}, async (page) => {
        assert.match(await page.locator(".sheet").innerText(), /✕ Failed\s+No step inspected this part\.[\s\S]*align failed[\s\S]*needs at least 3 points/);
        assert.equal(await page.locator(".deviation-chart, table").count(), 0);
    });
    browserTest("Part_Doubtful_SaysWhoAcknowledged", "sheet-several", {}, async (page) => {
        const text = await part(page, "bracket-04.ply").innerText();
        assert.match(text, /\? Doubtful[\s\S]*Doubts acknowledged by Ben, 2026-11-20: the supplier exports it so[\s\S]*Doubt: the nominal is inside out/);
        assert.match(await part(page, "bracket-07.ply").innerText(), /Warning: inspect: chord-error/);
    });
    browserTest("Part_HostileNames_AreShownAsText", "sheet-hard", {}, async (page) => {
        for (const text of ["we ird'<script>.ply", "<b>markup</b> &", "<i>variant</i>", "input-1-<b>"]) assert.ok((await page.locator("main").innerText()).includes(text), text);
        assert.equal(await page.locator("main script, main b, main i").count(), 0);
    });
    browserTest("Chart_Tolerance_IsABandAtItsPlaceWithUnits", "sheet-one", {}, async (page) => {
        const chart = page.locator(".deviation-chart");
        const texts = await chart.locator("text").allTextContents();
        for (const text of ["−0.1", "−0.05", "+0.1", "+0.2", "0", "deviation in mm", "share of the points", "tolerance"]) assert.ok(texts.includes(text), text);
        const ends = (selector) => chart.locator(selector).evaluate((rect) => [Number(rect.getAttribute("x")), Number(rect.getAttribute("x")) + Number(rect.getAttribute("width"))]);
        const [from, to] = await ends(".band");
        const axis = await chart.locator("line.base").first().evaluate((line) => [Number(line.getAttribute("x1")), Number(line.getAttribute("x2"))]);
        // From -0.05 to 0.1 on an axis from -0.1 to 0.2.
        assert.ok(Math.abs((from - axis[0]) / (axis[1] - axis[0]) - 1 / 6) < 1e-6 && Math.abs((to - axis[0]) / (axis[1] - axis[0]) - 2 / 3) < 1e-6);
        assert.equal(await chart.locator("rect.bar").count(), 41);
        const heights = await chart.locator("rect.bar").evaluateAll((bars) => bars.map((bar) => Number(bar.getAttribute("height"))));
        const { shares } = readData("sheet-one").sheets[0].inspection.histogram;
        assert.equal(heights.indexOf(Math.max(...heights)), shares.indexOf(Math.max(...shares)));
        assert.match(await chart.locator("svg").getAttribute("aria-label"), /tolerance −0\.05 to \+0\.1 mm/);
        const channels = await chart.locator("rect.bar").evaluateAll((bars) => bars.map((bar) => bar.getAttribute("fill").match(/\d+/g).map(Number)));
        assert.ok(channels[0][2] > channels[0][0] && channels.at(-1)[0] > channels.at(-1)[2], "blue is inside, red is outside");
    });
    browserTest("Labels_OutsideTolerance_HaveSymbolsAndWords", "sheet-one", {}, async (page) => {
        const [low, high] = [-0.05, 0.1];
        const rows = await page.locator(".labels tbody tr").evaluateAll((all) => all.map((row) => [...row.cells].map((cell) => cell.textContent)));
        assert.ok(rows.length >= 5);
        readData("sheet-one").sheets[0].inspection.labels.slice(0, rows.length).forEach((label, index) => {
            assert.equal(rows[index][0], String(index + 1));
            assert.equal(rows[index][2], label.value > high ? "▲above" : label.value < low ? "▼below" : "within");
            assert.deepEqual(rows[index].slice(3), label.position.map((text) => text.replace(" mm", "").replace("-", "−")));
        });
        assert.match(await page.locator(".labels + .key, .scroll + .key").first().innerText(), /▲ above the tolerance/);
    });
    browserTest("Numbers_InAColumn_HaveTheirPointsBelowEachOther", "sheet-one", {}, async (page) => {
        const points = await page.locator(".labels tbody td:nth-child(4)").evaluateAll((cells) => cells.flatMap((cell) => {
            const at = cell.textContent.indexOf(".");
            if (at < 0) return [];
            const range = document.createRange();
            range.setStart(cell.firstChild, at);
            range.setEnd(cell.firstChild, at + 1);
            return [range.getBoundingClientRect().left];
        }));
        assert.ok(points.length > 3 && Math.max(...points) - Math.min(...points) < 1, points.join(" "));
    });
    browserTest("Sheet_Dark_IsPaper", "sheet-one", { colorScheme: "dark" }, async (page) => {
        const colour = (selector) => page.locator(selector).first().evaluate((one) => [getComputedStyle(one).backgroundColor, getComputedStyle(one).color]);
        assert.deepEqual(await colour("main > .sheet"), ["rgb(255, 255, 255)", "rgb(22, 25, 29)"]);
        assert.notEqual((await colour("body"))[0], "rgb(255, 255, 255)");
    });
});

describe("the inspection of a cell", () => {
    browserTest("Cell_Inspected_ShowsLimitsPartsLabelsAndFacts", "inspected", { hash: "#cell-1" }, async (page) => {
        const section = page.locator("dialog section.part", { has: page.locator("h3", { hasText: /^Inspection$/ }) });
        const { inspection } = readData("inspected").cells[0];
        assert.match(await section.innerText(), /Tolerance −0\.05 to \+0\.1 mm\. In tolerance 92\.09\s%; expected: at least 99\s%\./);
        assert.equal(await section.locator(".parts tbody tr").count(), 41);
        assert.equal(await section.locator(".parts thead th").count(), 1 + inspection.columns.length);
        assert.equal(await section.locator(".parts thead abbr").nth(1).getAttribute("title"), inspection.columns[1].help);
        assert.equal(await section.locator(".labels tbody tr").count(), 20);
        assert.match(await section.innerText(), /alignment-rms\s+0\.01233 mm/);
        assert.equal(await section.locator(".deviation-chart").count(), 1);
        assert.ok(await section.locator(".scroll").first().evaluate((one) => one.scrollHeight > one.clientHeight));
    });
    browserTest("Cell_NoHistogramOfItsOwn_ShowsThatOfTheInspection", "inspected", { hash: "#cell-2" }, async (page) => {
        const section = page.locator("dialog .inspection");
        assert.equal(await section.locator(".deviation-chart .band").count(), 1);
        assert.match(await section.innerText(), /The workflow sets no limit for this part\./);
    });
    browserTest("Cell_NotInspected_HasNoSection", "inspected", { hash: "#cell-3" }, async (page) => {
        assert.equal(await page.locator("dialog .inspection, dialog .numbered").count(), 0);
    });
    browserTest("Values_Numbered_AreFolded", "inspected", { hash: "#cell-1" }, async (page) => {
        const folded = page.locator("dialog details.numbered");
        // 41 bins, 20 labels with three coordinates, 40 parts.
        assert.equal(await folded.locator("summary").innerText(), `${41 + 4 * 20 + 40} numbered values`);
        const names = await page.locator("dialog .part > .scroll .values tbody th").allTextContents();
        assert.ok(names.includes("rms") && names.includes("hausdorff"));
        assert.deepEqual(names.filter((name) => /@|^histogram|^label/.test(name)), []);
        await folded.locator("summary").click();
        assert.ok(await folded.getByText("label-x@20", { exact: true }).isVisible());
    });
    browserTest("Cell_Width400_DoesNotScroll", "inspected", { width: 400, height: 800, hash: "#cell-1" }, async (page) => {
        assert.ok(await page.locator("dialog").evaluate((dialog) => dialog.scrollWidth <= dialog.clientWidth));
    });
    browserTest("Print_InspectedCell_ClipsNoTable", "inspected", { width: 690, hash: "#cell-1" }, async (page) => {
        await page.emulateMedia({ media: "print" });
        await page.locator(":root.paper").waitFor();
        const clipped = await page.locator(".paper-cell .scroll, .paper-cell table").evaluateAll((all) => all.filter((one) => one.clientWidth > 0 && one.scrollWidth > one.clientWidth + 1).map((one) => one.ariaLabel));
        assert.deepEqual(clipped, []);
        assert.equal(await page.locator(".paper-cell .parts tbody tr").last().isVisible(), true);
        assert.match(await page.locator(".paper-cell details.numbered").innerText(), /161 numbered values/);
    });
});
