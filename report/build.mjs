// SPDX-License-Identifier: GPL-3.0-or-later
// Builds dist/page.html: the page with its styles and scripts, and one place for the data.
import { build, transform } from "esbuild";
import { mkdir, readFile, readdir, writeFile } from "node:fs/promises";

const here = new URL(".", import.meta.url).pathname;
const place = '<script type="application/json" id="data">null</script>';

const bundle = await build({
    entryPoints: [`${here}src/main.ts`],
    bundle: true,
    minify: true,
    write: false,
    format: "iife",
    target: ["es2022"],
    charset: "utf8",
    legalComments: "inline",
    loader: { ".css": "text" },
});
const script = bundle.outputFiles[0].text;

const sheets = (await readdir(`${here}src/style`)).filter((name) => name.endsWith(".css")).sort();
const texts = await Promise.all(sheets.map((name) => readFile(`${here}src/style/${name}`, "utf8")));
const library = await readFile(`${here}node_modules/uplot/dist/uPlot.min.css`, "utf8");
const style = (await transform([library, ...texts].join("\n"), { loader: "css", minify: true, charset: "utf8" })).code;

const template = await readFile(`${here}src/page.html`, "utf8");
const page = template.replace("/* style */", () => style).replace("/* script */", () => script);

// A script ends at the first "</script", and "<!--" changes how its end is found.
if (/<\/script|<!--/i.test(script)) throw new Error("the script contains '</script' or '<!--'");
if (/<\/style/i.test(style)) throw new Error("the styles contain '</style'");
if (page.split(place).length !== 2) throw new Error("the page must have one place for the data");

await mkdir(`${here}dist`, { recursive: true });
await writeFile(`${here}dist/page.html`, page);
console.log(`dist/page.html: ${(page.length / 1000).toFixed(0)} kB`);
