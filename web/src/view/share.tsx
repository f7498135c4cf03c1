// Sharing of what is shown: as pictures, code, links and files.

import { useState } from "preact/hooks";

import type { Problem, Questions, Saved } from "../engine/engine.ts";
import { linkPart } from "../state/link.ts";
import { PANES, QUALITIES, type ViewerState, type ViewName } from "../state/state.ts";
import { Choice, Switch } from "./fields.tsx";
import { openState } from "./open_state.ts";
import type { PartProps } from "./part.ts";
import { problemOf } from "./problems.ts";
import { nameOf } from "./slices/panes.ts";

const SIZES: readonly (readonly [string, string])[] = [
  ["view", "As in the window"],
  ["2", "Twice as large"],
  ["1920x1080", "1920 x 1080"],
  ["3840x2160", "3840 x 2160"],
  ["own", "Own size"],
];
const MAX_SIDE = 8192;

/** The view that a page of one view shows; "all" where it shows several. */
export function seenView({ layout }: ViewerState["view"]): ViewName | "all" {
  if (layout.name === "single") return layout.main;
  return layout.name === "3d" ? "3d" : "all";
}

export function SharePanel(props: PartProps) {
  const { store, engine, ui } = props;
  const [chosen, setChosen] = useState<"seen" | ViewName | "all">("seen");
  const [size, setSize] = useState("view");
  const [own, setOwn] = useState<readonly [number, number]>([1600, 1200]);
  const [quality, setQuality] = useState("");
  const [transparent, setTransparent] = useState(false);
  const [annotated, setAnnotated] = useState(true);
  const [part, setPart] = useState<number | null>(null);
  const [abort, setAbort] = useState<AbortController | null>(null);
  const [text, setText] = useState("");

  const shown = chosen === "seen" ? seenView(store.state.view) : chosen;
  const wanted = (): Saved => ({
    ...pixelsOf(props, shown, size, own), shown, transparent, annotated, ...(quality === "" ? {} : { quality }),
  });

  const picture = async (use: (bytes: Uint8Array<ArrayBuffer>, name: string) => Promise<void> | void): Promise<void> => {
    const controller = new AbortController();
    setAbort(controller);
    setPart(0);
    try {
      const { bytes, notes, name } = await engine.ask("picture", wanted(), setPart, controller.signal);
      await use(bytes, name);
      for (const note of notes) ui.announce(note);
    } catch (problem) {
      if ((problem as Problem).code !== "cancelled") ui.problem(problemOf(problem));
    } finally {
      setPart(null);
      setAbort(null);
    }
  };

  const code = async (as: Questions["code"]["question"]["as"], use: (text: string, name: string) => Promise<void> | void) => {
    try {
      const found = await engine.ask("code", { as, ...wanted() });
      await use(found.text, found.name);
    } catch (problem) {
      ui.problem(problemOf(problem));
    }
  };

  const copy = async (what: string, name: string): Promise<void> => {
    // Shown too, so that it can be copied by hand.
    setText(what);
    try {
      await navigator.clipboard.writeText(what);
      ui.announce(`${name} is copied`);
    } catch {
      ui.announce(`${name} is in the field below`);
    }
  };

  /** A link that opens once, in any browser of this machine, by a token of its own. */
  const link = (): Promise<void> =>
    code("link", async (state) => {
      const found = await linkPart(state);
      if (found === null) {
        ui.problem({ code: "link", message: "The state is too long for a link", remedy: "Save it as a file instead." });
        return;
      }
      const { token } = await engine.ask("token", {});
      await copy(`${location.origin}${location.pathname}#token=${token}&state=${found}`, "The link, which opens once,");
    });

  return (
    <>
      <Choice label="Picture of" value={chosen} options={viewChoices(props)} onChoose={(name) => setChosen(name as typeof chosen)} />
      <Choice label="Size" value={size} options={SIZES} onChoose={setSize} />
      {size === "own" && (
        <div class="row">
          {(["Width", "Height"] as const).map((name, n) => (
            <label key={name} class="row">
              {name}
              <input
                type="number"
                min={1}
                max={MAX_SIDE}
                value={own[n]}
                onChange={(event) => {
                  const value = Math.min(Math.max(Math.round(event.currentTarget.valueAsNumber || 1), 1), MAX_SIDE);
                  setOwn(n === 0 ? [value, own[1]] : [own[0], value]);
                }}
              />
            </label>
          ))}
        </div>
      )}
      <Choice label="Quality" value={quality} options={[["", "As in the window"], ...QUALITIES.slice(1).map((name) => [name, name] as const)]} onChoose={setQuality} />
      <Switch label="Transparent background" on={transparent} onToggle={setTransparent} />
      <Switch label="With measures, bars and legend" on={annotated} onToggle={setAnnotated} />
      <div class="row">
        <button class="button" disabled={part !== null} onClick={() => void picture((bytes, name) => ui.download(name, bytes, "image/png"))}>Save picture</button>
        <button
          class="button"
          disabled={part !== null}
          onClick={() =>
            void picture(async (bytes) => {
              if (typeof ClipboardItem === "undefined") throw new Error("This browser cannot copy pictures; save it instead");
              await navigator.clipboard.write([new ClipboardItem({ "image/png": new Blob([bytes], { type: "image/png" }) })]);
              ui.announce("The picture is copied");
            })
          }
        >
          Copy picture
        </button>
        {abort !== null && <button class="button" onClick={() => abort.abort()}>Cancel</button>}
      </div>
      {part !== null && <progress aria-label="Drawing the picture" max={1} value={part} />}
      <div class="row">
        <button class="button" onClick={() => void code("python", (found) => copy(found, "The Python program"))}>Copy as Python</button>
        <button class="button" onClick={() => void code("command", (found) => copy(found, "The command"))}>Copy as command</button>
        {ui.host === "page" && <button class="button" onClick={() => void link()}>Copy link</button>}
      </div>
      {text !== "" && <textarea aria-label="What was copied" readOnly rows={5} value={text} onFocus={(event) => event.currentTarget.select()} />}
      <div class="row">
        <button class="button" onClick={() => void code("state", (found, name) => ui.download(name, found, "application/json"))}>Save state</button>
        <label class="button">
          Open state
          <input
            class="hidden"
            type="file"
            accept=".json,application/json"
            onChange={(event) => {
              const file = event.currentTarget.files?.[0];
              event.currentTarget.value = "";
              if (file !== undefined) void openState(props, file);
            }}
          />
        </label>
        <button class="button" onClick={() => void code("html", (found, name) => ui.download(name, found, "text/html"))}>Save page (HTML)</button>
      </div>
    </>
  );
}

/** The choices of what a picture shows, by their names for people. */
function viewChoices(props: PartProps): readonly (readonly [string, string])[] {
  const slices = PANES.map((pane) => [pane, `${nameOf(props, pane)} slice`] as const);
  return [["seen", "What is seen"], ["3d", "Picture in space"], ...slices, ["all", "All four, two by two"]];
}

/** The size of a saved picture in pixels. */
function pixelsOf(
  { ui }: PartProps,
  shown: ViewName | "all",
  size: string,
  own: readonly [number, number],
): { width: number; height: number } {
  if (size === "own") return { width: own[0], height: own[1] };
  if (size.includes("x")) {
    const [width = 0, height = 0] = size.split("x").map(Number);
    return { width, height };
  }
  const frame = shown === "all" ? undefined : ui.frames[shown];
  const scale = Number(frame?.settings["scale"] ?? 1);
  // Of several views, and of views that are not on the screen: the area of all views.
  const area = ui.root.querySelector(".views")?.getBoundingClientRect();
  const ratio = window.devicePixelRatio || 1;
  const [width, height] = frame === undefined
    ? [(area?.width ?? 1024) * ratio, (area?.height ?? 768) * ratio]
    : [frame.width / scale, frame.height / scale];
  const factor = size === "2" ? 2 : 1;
  return { width: Math.min(Math.round(factor * width), MAX_SIDE), height: Math.min(Math.round(factor * height), MAX_SIDE) };
}
