// SPDX-License-Identifier: GPL-3.0-or-later
// Builds dist/page.html, the report page, and dist/sheet.html, the inspection sheets: each with its styles and scripts, and one
// place for the data.
import { build, transform } from "esbuild";
import { mkdir, readFile, readdir, writeFile } from "node:fs/promises";

const here = new URL(".", import.meta.url).pathname;
const place = '<script type="application/json" id="data">null</script>';
const template = await readFile(`${here}src/page.html`, "utf8");
const numbered = (await readdir(`${here}src/style`)).filter((name) => /^\d.*\.css$/.test(name)).sort();

await mkdir(`${here}dist`, { recursive: true });
await write("page", "main.ts", ["node_modules/uplot/dist/uPlot.min.css", ...numbered.map((name) => `src/style/${name}`)]);
await write("sheet", "sheet.ts", ["src/style/1_base.css", "src/style/3_inspection.css", "src/style/sheet.css"]);

async function write(name, entry, sheets) {
    const bundle = await build({
        entryPoints: [`${here}src/${entry}`],
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
    const texts = await Promise.all(sheets.map((sheet) => readFile(here + sheet, "utf8")));
    const style = (await transform(texts.join("\n"), { loader: "css", minify: true, charset: "utf8" })).code;
    const page = template.replace("/* style */", () => style).replace("/* script */", () => script);

    // A script ends at the first "</script", and "<!--" changes how its end is found.
    if (/<\/script|<!--/i.test(script)) throw new Error(`the script of ${name} contains '</script' or '<!--'`);
    if (/<\/style/i.test(style)) throw new Error(`the styles of ${name} contain '</style'`);
    if (page.split(place).length !== 2) throw new Error(`${name} must have one place for the data`);

    await writeFile(`${here}dist/${name}.html`, page);
    console.log(`dist/${name}.html: ${(page.length / 1000).toFixed(0)} kB`);
}
