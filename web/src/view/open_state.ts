// Files of the viewer's state.

import type { PartProps } from "./part.ts";
import { WORDS } from "../words.ts";
import { problemOf } from "./problems.ts";

/** Shows the state of a file; the volumes stay. */
export async function openState({ engine, store, ui }: PartProps, file: File): Promise<void> {
  try {
    const { state } = await engine.ask("open_state", { text: await file.text() });
    store.change([{ op: "replace", path: "", value: state }]);
    ui.announce(WORDS.opening.shown(file.name));
  } catch (problem) {
    ui.problem(problemOf(problem));
  }
}
