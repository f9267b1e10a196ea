// Makes server/static/bundle, all that browsers get: scripts, styles, pictures and type under names with a hash of
// their content, which a browser may keep for ever, with copies by gzip and brotli. manifest.json tells the names.

import { createHash } from "node:crypto";
import { mkdir, readFile, rm, writeFile } from "node:fs/promises";
import { basename, dirname, extname } from "node:path";
import { fileURLToPath } from "node:url";
import { brotliCompressSync, constants, gzipSync } from "node:zlib";
import { build } from "esbuild";

const ROOT = dirname(fileURLToPath(import.meta.url));
const BUNDLE = `${ROOT}/bundle`;
const SCRIPTS = [
  "common/text_page", "desk/operator", "entrance/index", "game/home", "game/pulse", "lobby/index", "lobby/second", "results/results", "results/tournament",
  "watch/watch",
];
const STYLES = [
  "about", "arena", "camera", "common", "controls", "entrance", "error", "feed", "floor", "guide", "hits", "home", "hud", "keys", "lobby", "login", "operator",
  "own_camera", "podium", "results", "teams", "touch", "tournament", "watch",
];
const AVATARS = [0, 1, 2, 3, 4].map((number) => `avatar${number}.svg`);
const PICTURES = [...AVATARS, "broken.svg", "favicon.png", "favicon.svg", "logo.svg"];
const COMPRESSED = /\.(js|css|svg|map)$/; // the others are compressed by nature
const HASH = /-[0-9A-Z]{8}\./;
const LEAST = 400; // bytes; below it a compressed copy gains nothing

async function copyPictures() {
  const names = {};
  for (const picture of PICTURES) {
    const content = await readFile(`${ROOT}/img/${picture}`);
    const hash = createHash("sha256").update(content).digest("hex").slice(0, 8).toUpperCase();
    const name = `${basename(picture, extname(picture))}-${hash}${extname(picture)}`;
    await writeFile(`${BUNDLE}/${name}`, content);
    names[`img/${picture}`] = name;
  }
  return names;
}

/** The names of the scripts and styles; `pictures` is what assets.js knows. */
async function bundle(pictures) {
  const { metafile } = await build({
    absWorkingDir: ROOT,
    entryPoints: [...SCRIPTS.map((name) => `js/${name}.js`), ...STYLES.map((name) => `css/${name}.css`)],
    outdir: "bundle",
    entryNames: "[name]-[hash]",
    assetNames: "[name]-[hash]",
    bundle: true,
    minify: true,
    sourcemap: true,
    format: "esm",
    target: "es2022",
    loader: { ".woff2": "file" },
    define: { PICTURES: JSON.stringify(pictures) },
    metafile: true,
  });
  const names = {};
  for (const [path, { entryPoint }] of Object.entries(metafile.outputs)) {
    if (entryPoint) names[entryPoint] = basename(path);
  }
  const files = Object.keys(metafile.outputs).map((path) => basename(path));
  for (const font of files.filter((file) => file.endsWith(".woff2"))) names[`type/${font.replace(HASH, ".")}`] = font;
  return { names, files };
}

async function compress(file) {
  const path = `${BUNDLE}/${file}`;
  const content = await readFile(path);
  if (!COMPRESSED.test(file) || content.length < LEAST) return;
  const quality = { params: { [constants.BROTLI_PARAM_QUALITY]: constants.BROTLI_MAX_QUALITY } };
  await writeFile(`${path}.br`, brotliCompressSync(content, quality));
  await writeFile(`${path}.gz`, gzipSync(content, { level: 9 }));
}

await rm(BUNDLE, { recursive: true, force: true });
await mkdir(BUNDLE);
const pictures = await copyPictures();
const { names, files } = await bundle(pictures);
await Promise.all([...files, ...Object.values(pictures)].map(compress));
const manifest = Object.fromEntries(Object.entries({ ...names, ...pictures }).sort());
await writeFile(`${BUNDLE}/manifest.json`, `${JSON.stringify(manifest, null, 2)}\n`);
