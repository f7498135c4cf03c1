// Notes on a picture as the page shows them.

import { expect, test } from "vitest";

import { FreshNotes, noteForPage, NOTED_MS } from "../src/view/notes.ts";

test.each([
  ["the table is left out of the picture, and stays in the samples; --keep-table (keep_table=True) draws it",
    "The table is left out of the picture, and stays in the samples"],
  ["the picture is empty; try --preset auto", "The picture is empty"],
  ["a face can be recognised; deface the scan (pydeface, mri_deface), or cut the face off (--cut-out, --clip)",
    "A face can be recognised; deface the scan (pydeface, mri_deface), or cut the face off"],
  ["the light is behind", "The light is behind"],
])("%s", (note, shown) => expect(noteForPage(note)).toBe(shown));

test("a note is shown for ten seconds, and not again when the picture comes to rest again", () => {
  const notes = new FreshNotes();
  expect(notes.of(["a"], 0)).toEqual(["a"]);
  expect(notes.of([], 1000)).toEqual([]);
  expect(notes.of(["a", "b"], 2000)).toEqual(["a", "b"]);
  expect(notes.of(["a", "b"], NOTED_MS)).toEqual(["b"]);
  expect(notes.of(["a", "b"], NOTED_MS + 2000)).toEqual([]);
});
