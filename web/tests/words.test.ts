// All words of the page are in its tables, so that it can be translated.

import { readdirSync, readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";

import { expect, test } from "vitest";

const VIEW = fileURLToPath(new URL("../src/view/", import.meta.url));
const PARTS = readdirSync(VIEW, { recursive: true, encoding: "utf8" }).filter((name) => name.endsWith(".tsx"));
/** Attributes whose texts are read or heard, and texts between tags, with words in the code. */
const INLINE = [/\b(?:label|aria-label|title|text|placeholder)=(?:"[^"]*|\{`[^`]*)[A-Za-z]{3}/, />\s*[A-Z][a-z]+[^<>{}=;()]*<\//];

/** Code without comments, and without what templates insert. */
const bare = (code: string): string => code.replaceAll(/\/\*[\s\S]*?\*\/|\/\/ .*/g, "").replaceAll(/\$\{[^{}]*\}/g, "");

const ENGINE = fileURLToPath(new URL("../src/engine/", import.meta.url));

test.each(readdirSync(ENGINE))("engine/%s has no words for people of its own", (name) => {
  const lines = bare(readFileSync(ENGINE + name, "utf8")).split("\n");
  expect(lines.filter((line) => /\b(?:remedy|text): .*["`][A-Z]/.test(line))).toEqual([]);
});

test.each(PARTS)("%s has no words of its own", (name) => {
  const lines = bare(readFileSync(VIEW + name, "utf8")).split("\n");
  expect(lines.filter((line) => INLINE.some((pattern) => pattern.test(line)))).toEqual([]);
});
