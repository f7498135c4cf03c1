// The npm package: its types are those of the module that it has.

import { expect, test } from "vitest";
import type declared from "../package/index.d.ts";
import viewer from "../src/widget.ts";

test("the module is what its types say", () => {
  const one: typeof declared = viewer;
  const other: typeof viewer = one;
  expect(Object.keys(other)).toEqual(["render"]);
});
