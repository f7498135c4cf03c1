// The documentation site in Chromium: `node site.mjs FOLDER`; `make site-test` builds it and runs this.
//
// Every page, on a desktop and on a phone, dark on one and light on the other: nothing is wider than the window, every
// picture is there, and no script fails. One page of each kind, light and dark: axe finds nothing serious. Search finds
// the words of the field. The site is opened from its folder, as a reader without a server would.
import { mkdtempSync, readFileSync, readdirSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join, relative, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const [, , folder = "../out/site", only = ""] = process.argv;
const SITE = resolve(folder);
const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const DESKTOP = { width: 1280, height: 800 };
const PHONE = { width: 390, height: 844 };
/** Pages of each kind: front page, text with pictures, tables, code, the reference of Python, of the command, of documents. */
const KINDS = [
  "docs/site/index", "docs/site/start", "docs/concepts", "docs/gallery", "docs/limits", "docs/accuracy", "docs/how_to/README", "docs/how_to/figures",
  "docs/coming_from", "docs/glossary", "docs/notebooks/first", "docs/site/reference/pictures", "docs/site/reference/command_line",
  "docs/site/reference/scene_documents", "benches/README", "search",
];
/** Words that people look for, and a part of the address of a page that must be among what is found. */
const WORDS = {
  DICOM: "dicom", NIfTI: "radiology", "OME-Zarr": "ome_zarr", Imaris: "channels_and_time", isosurface: "coming_from",
  "maximum intensity": "microscopy", "transfer function": "concepts", opacity: "concepts", Hounsfield: "radiology",
  SUV: "radiology", segmentation: "radiology", "scale bar": "figures", turntable: "turns_and_flights", wavelet: "wavelet",
  ParaView: "coming_from_paraview", napari: "coming_from", Fiji: "coming_from", netCDF: "simulations", privacy: "privacy",
  shadow: "concepts", perspective: "reference", cluster: "large_volumes", movie: "movies", GPU: "gpu", cite: "faq", notebook: "notebooks", STL: "segmentations",
};
const SEARCH_MS = 30_000;

const faults = [];
const pages = readdirSync(SITE, { recursive: true })
  .map(String)
  // The first page leads on to another one.
  .filter((name) => name.endsWith(".html") && name !== "index.html" && !/(^|\/)(_static|_modules)\//.test(name) && !name.startsWith("rust/") && name.includes(only))
  .sort();
if (pages.length === 0) throw new Error(`${SITE} has no pages; build it by \`make site\``);
const address = (name) => pathToFileURL(join(SITE, name)).href;

/** Opens a window of a size and a colour scheme, and calls a function with its page and the errors of its scripts. */
async function inWindow(viewport, colorScheme, work) {
  const profile = mkdtempSync(join(tmpdir(), "wavesplat-site-"));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: "/usr/bin/chromium",
    headless: true,
    viewport,
    colorScheme,
    args: ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--allow-file-access-from-files"],
  });
  const page = context.pages()[0] ?? (await context.newPage());
  const errors = [];
  page.on("pageerror", (error) => errors.push(error.message));
  await work(page, errors);
  await context.close();
  rmSync(profile, { recursive: true, force: true });
}

/** What is wrong with the page that is open: its width, and pictures that are not there. */
function lookAt() {
  const found = [];
  const wide = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  if (wide > 1) {
    const edge = document.documentElement.clientWidth;
    const widest = [...document.querySelectorAll("main *")].filter((one) => one.getBoundingClientRect().right > edge + 1).at(0);
    found.push(`it is ${wide} px wider than the window: ${widest?.outerHTML.slice(0, 120)}`);
  }
  for (const image of document.images) {
    if (image.complete && image.naturalWidth === 0 && image.getAttribute("src")) found.push(`no picture: ${image.getAttribute("src")}`);
    if (!image.hasAttribute("alt")) found.push(`a picture without words: ${image.getAttribute("src")}`);
  }
  return found;
}

async function everyPage(viewport, scheme, what) {
  await inWindow(viewport, scheme, async (page, errors) => {
    for (const name of pages) {
      await page.goto(address(name), { waitUntil: "load" });
      // Pictures below the window are loaded when they are near.
      await page.evaluate(() => Promise.all([...document.images].map((image) => { image.loading = "eager"; return image.decode().catch(() => {}); })));
      for (const fault of [...(await page.evaluate(lookAt)), ...errors.splice(0)]) faults.push(`${name}, ${what}: ${fault}`);
    }
  });
}

async function axe(scheme) {
  await inWindow(DESKTOP, scheme, async (page) => {
    for (const name of KINDS.map((kind) => `${kind}.html`).filter((name) => pages.includes(name))) {
      await page.goto(address(name), { waitUntil: "load" });
      await page.evaluate(AXE);
      const { violations } = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ["violations"] }));
      for (const { id, impact, help, nodes } of violations) {
        if (impact === "serious" || impact === "critical")
          faults.push(`${name}, ${scheme}: ${id} (${impact}): ${help}: ${nodes.length} times, as ${nodes[0].html.slice(0, 140)}`);
      }
    }
  });
}

async function search() {
  await inWindow(DESKTOP, "light", async (page) => {
    for (const [words, part] of Object.entries(WORDS)) {
      await page.goto(`${address("search.html")}?q=${encodeURIComponent(words)}`);
      const done = await page.waitForFunction(() => /finished|found/i.test(document.querySelector(".search-summary")?.textContent ?? ""), null, { timeout: SEARCH_MS }).catch(() => null);
      const links = await page.$$eval("ul.search li a", (all) => all.map((one) => one.getAttribute("href") ?? ""));
      if (done === null) faults.push(`search for ${words} did not end`);
      else if (!links.some((link) => link.includes(part))) faults.push(`search for ${words} finds no page ${part}, but ${links.slice(0, 5).join(", ")}`);
    }
  });
}

const began = Date.now();
await everyPage(DESKTOP, "dark", "on a desktop, dark");
await everyPage(PHONE, "light", "on a phone, light");
if (only === "") {
  await axe("light");
  await axe("dark");
  await search();
}
for (const fault of faults) console.error(fault);
const seconds = ((Date.now() - began) / 1000).toFixed(0);
console.log(`${pages.length} pages of ${relative(process.cwd(), SITE)} in ${seconds} s, ${Object.keys(WORDS).length} searches: ${faults.length} faults`);
process.exitCode = faults.length === 0 ? 0 : 1;
