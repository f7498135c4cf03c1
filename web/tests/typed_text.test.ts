import { expect, test } from "vitest";

import { TypedText } from "../src/input/typed_text.ts";

test("Escape puts back the text before the first letter, and what a field has taken stays", () => {
  const field = Object.assign(new EventTarget(), { value: "2" });
  const typed = new TypedText(field);
  const told: string[] = [];
  field.addEventListener("input", () => told.push(field.value));
  const type = (text: string): void => {
    field.dispatchEvent(new Event("beforeinput"));
    field.value = text;
  };
  expect([typed.isWaiting, typed.takeBack()]).toEqual([false, false]);
  type("3");
  type("37");
  expect([typed.isWaiting, typed.takeBack(), field.value, typed.isWaiting]).toEqual([true, true, "2", false]);
  expect(told).toEqual(["2"]);
  for (const end of ["change", "focusout"]) {
    type("5");
    field.dispatchEvent(new Event(end));
    expect([typed.isWaiting, typed.takeBack(), field.value]).toEqual([false, false, "5"]);
  }
});
