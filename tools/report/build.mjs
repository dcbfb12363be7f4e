// SPDX-License-Identifier: GPL-3.0-or-later
// Bundles the page: node build.mjs FOLDER_WITH_NODE_MODULES poke.wasm OUT.html NOTICE...
// NOTICE: PACKAGE/copyright, the licence text of a library in poke.wasm.
import { createRequire } from "node:module";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { deflateSync } from "node:zlib";

const [folder, wasm, out, ...texts] = process.argv.slice(2);
const here = path.dirname(fileURLToPath(import.meta.url));
const { build } = createRequire(path.join(path.resolve(folder), "package.json"))("esbuild");

async function bundle(entry, plugins = []) {
  const result = await build({
    entryPoints: [path.join(here, "page", entry)],
    bundle: true,
    minify: true,
    write: false,
    metafile: true,
    format: "iife",
    target: "es2022",
    legalComments: "none",
    nodePaths: [path.join(folder, "node_modules")],
    plugins,
  });
  return { text: result.outputFiles[0].text, inputs: Object.keys(result.metafile.inputs) };
}

/** Packages whose code is in the bundle, with their licence texts: the page shows all of them. */
function notices(inputs) {
  const names = new Set();
  for (const input of inputs) {
    const inside = input.split("node_modules/").pop();
    if (!input.includes("node_modules/")) continue;
    const parts = inside.split("/");
    names.add(inside.startsWith("@") ? parts.slice(0, 2).join("/") : parts[0]);
  }
  return [...names].sort().map((name) => {
    const root = path.join(folder, "node_modules", name);
    const { version, license } = JSON.parse(readFileSync(path.join(root, "package.json"), "utf8"));
    const file = readdirSync(root).find((entry) => /^licen[cs]e/i.test(entry));
    if (!file) throw new Error(`${name} has no licence text: it cannot be in the page`);
    return { name, version, license, text: readFileSync(path.join(root, file), "utf8") };
  });
}

const escape = (text) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;");
const packed = (bytes) => deflateSync(bytes, { level: 9 }).toString("base64");
const block = (id, bytes) => `<script type="application/octet-stream" id="${id}">${packed(bytes)}</script>`;

const worker = await bundle("worker.js");
const main = await bundle("main.js", [
  {
    name: "worker",
    setup(builder) {
      builder.onResolve({ filter: /^worker:text$/ }, () => ({ path: "worker", namespace: "worker" }));
      builder.onLoad({ filter: /.*/, namespace: "worker" }, () => ({ contents: worker.text, loader: "text" }));
    },
  },
]);

const notice = (name, license, file) => ({ name, version: "", license, text: readFileSync(file, "utf8") });
const module = texts.map((file) => notice(path.basename(path.dirname(file)), "see text", file));
const own = [
  notice("palpate runtime", "MIT", path.join(here, "../../runtime/LICENSE")),
  notice("palpate page", "GPL-3.0-or-later", path.join(here, "../../LICENSES/GPL-3.0-or-later.txt")),
];
const licences = [...own, ...notices([...main.inputs, ...worker.inputs]), ...module]
  .map(({ name, version, license, text }) => `<details><summary>${name} ${version}, ${escape(license)}</summary><pre>${escape(text)}</pre></details>`)
  .join("\n");

const html = readFileSync(path.join(here, "page/index.html"), "utf8")
  .replace("/*STYLE*/", () => readFileSync(path.join(here, "page/style.css"), "utf8"))
  .replace("<!--LICENCES-->", () => licences)
  .replace("<!--PROGRAM-->", () => block("palpate-program", Buffer.from(main.text)) + "\n" + block("palpate-poke", readFileSync(wasm)));
writeFileSync(out, html);
