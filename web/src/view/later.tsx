// Parts of the page that come after the first view, in a chunk of their own; in the widget's one file they are there.

import type { ComponentType } from "preact";
import { useEffect, useState } from "preact/hooks";

import { WORDS } from "../words.ts";

type Late = typeof import("./late_panels.ts");

/** Milliseconds after which the parts are loaded, wanted or not: then none is missing if the server ends later. */
const AHEAD_MS = 3000;

let late: Late | null = null;
let loading: Promise<void> | null = null;

/** Loads the parts; a failed try is made again the next time. */
function load(): Promise<void> {
  loading ??= import("./late_panels.ts").then(
    (found) => {
      late = found;
    },
    (error: unknown) => {
      loading = null;
      throw error;
    },
  );
  return loading;
}

/** Loads the parts a while after the first view, so that they are there when they are wanted. */
export function loadAhead(): void {
  setTimeout(() => void load().catch(() => undefined), AHEAD_MS);
}

/** A component that is loaded when it is first shown; until then nothing is in its place. */
export function later<P extends object>(choose: (parts: Late) => ComponentType<P>): ComponentType<P> {
  return function Later(props: P) {
    const [problem, setProblem] = useState("");
    const [, redraw] = useState(false);
    useEffect(() => {
      if (late === null) load().then(() => redraw(true), () => setProblem(WORDS.status.partFailed));
    }, []);
    if (late === null) return problem === "" ? null : <p class="dim" role="alert">{problem}</p>;
    const Loaded = choose(late);
    return <Loaded {...props} />;
  };
}
