// Gathers in dist/ what the npm package `@wavesplat/viewer` consists of; `npm pack` and `npm publish` run it.
//   widget.js, index.d.ts   the module that anywidget loads, and its types
//   page/                   the page as a folder, whose files a web server gives out at its root
//   LICENSE-*               our terms, and those of what is bundled
import { cp, mkdir, rm } from "node:fs/promises";

const ROOT = new URL("../../", import.meta.url);
const CLIENT = new URL("python/wavesplat/_viewer/client/", ROOT);
const DIST = new URL("../dist/", import.meta.url);

await rm(DIST, { recursive: true, force: true });
await mkdir(DIST);
await cp(new URL("widget.js", CLIENT), new URL("widget.js", DIST));
await cp(new URL("index.d.ts", import.meta.url), new URL("index.d.ts", DIST));
await cp(new URL("page/", CLIENT), new URL("page/", DIST), { recursive: true });
for (const name of ["index.html", "favicon.svg"]) await cp(new URL(name, CLIENT), new URL(`page/${name}`, DIST));
for (const name of ["LICENSE-MIT", "LICENSE-APACHE"]) await cp(new URL(name, ROOT), new URL(name, DIST));
await cp(new URL("LICENSES-OF-OTHERS.txt", CLIENT), new URL("LICENSES-OF-OTHERS.txt", DIST));
