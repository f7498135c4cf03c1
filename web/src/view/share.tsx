// Sharing of what is shown: as pictures, code, links and files.

import { useEffect, useReducer, useState } from "preact/hooks";

import type { Problem, Questions, Saved } from "../engine/engine.ts";
import { linkPart } from "../state/link.ts";
import { PANES, QUALITIES, type ViewerState, type ViewName } from "../state/state.ts";
import { PANEL_WORDS } from "../panel_words.ts";
import { Choice, Switch } from "./fields.tsx";
import { openState } from "./open_state.ts";
import type { PartProps } from "./part.ts";
import { problemOf } from "./problems.ts";
import { nameOf } from "./slices/panes.ts";

const TEXT = PANEL_WORDS.share;
const SIZES: readonly (readonly [string, string])[] = [
  ["view", TEXT.sizes.view],
  ["2", TEXT.sizes[2]],
  ["1920x1080", "1920 × 1080"],
  ["3840x2160", "3840 × 2160"],
  ["own", TEXT.sizes.own],
];
const MAX_SIDE = 8192;

/** The view that a page of one view shows; "all" where it shows several. */
function seenView({ layout }: ViewerState["view"]): ViewName | "all" {
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
  useViewsResized(props);
  const now = pixelsOf(props, shown, size, own);
  const wanted = (): Saved => {
    const pixels = pixelsOf(props, shown, size, own);
    const camera = ui.camera.cameraFor(pixels.width / pixels.height);
    return { ...pixels, shown, transparent, annotated, camera, ...(quality === "" ? {} : { quality }) };
  };

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
      const { layout, interface: panels } = store.state.view;
      const found = await engine.ask("code", { as, ...wanted(), window: { layout, interface: panels } });
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
      ui.announce(TEXT.copied(name));
    } catch {
      ui.announce(TEXT.below(name));
    }
  };

  /** A link that opens once, in any browser of this machine, by a token of its own. */
  const link = (): Promise<void> =>
    code("link", async (state) => {
      const found = await linkPart(state);
      if (found === null) {
        ui.problem({ code: "link", message: TEXT.longLink, remedy: TEXT.longLinkRemedy });
        return;
      }
      const { token } = await engine.ask("token", {});
      await copy(`${location.origin}${location.pathname}#token=${token}&state=${found}`, TEXT.theLink);
    });

  return (
    <>
      <fieldset>
        <legend>{TEXT.picture}</legend>
        <Choice label={TEXT.of} value={chosen} options={viewChoices(props)} onChoose={(name) => setChosen(name as typeof chosen)} />
        <Choice label={TEXT.size} value={size} options={SIZES} onChoose={setSize} />
        {size === "own" && <OwnSize size={own} onSize={setOwn} />}
        <Choice
          label={TEXT.quality}
          value={quality}
          options={[["", TEXT.sizes.view], ...QUALITIES.slice(1).map((name) => [name, PANEL_WORDS.qualities[name]] as const)]}
          onChoose={setQuality}
        />
        <Switch label={TEXT.transparent} on={transparent} onToggle={setTransparent} />
        <Switch label={TEXT.annotated} on={annotated} onToggle={setAnnotated} />
        <p class="dim">{[TEXT.pixels(now.width, now.height, size in TEXT.sizes && size !== "own"), ...(annotated ? [TEXT.wider] : [])].join(" ")}</p>
        <div class="row">
          <button class="button first" disabled={part !== null} onClick={() => void picture((bytes, name) => ui.download(name, bytes, "image/png"))}>
            {TEXT.save}
          </button>
          <button
            class="button"
            disabled={part !== null}
            onClick={() =>
              void picture(async (bytes) => {
                if (typeof ClipboardItem === "undefined") throw new Error(TEXT.noCopy);
                await navigator.clipboard.write([new ClipboardItem({ "image/png": new Blob([bytes], { type: "image/png" }) })]);
                ui.announce(TEXT.copied(TEXT.thePicture));
              })
            }
          >
            {TEXT.copy}
          </button>
          {abort !== null && <button class="button" onClick={() => abort.abort()}>{TEXT.cancel}</button>}
        </div>
        {part !== null && <progress aria-label={TEXT.drawing} max={1} value={part} />}
      </fieldset>
      <fieldset>
        <legend>{TEXT.code}</legend>
        <div class="row">
          <button class="button" onClick={() => void code("python", (found) => copy(found, TEXT.thePython))}>{TEXT.python}</button>
          <button class="button" onClick={() => void code("command", (found) => copy(found, TEXT.theCommand))}>{TEXT.command}</button>
          <button class="button" onClick={() => void code("movie", (found) => copy(found, TEXT.theMovie))}>{TEXT.movie}</button>
          {ui.host === "page" && <button class="button" onClick={() => void link()}>{TEXT.link}</button>}
        </div>
        {text !== "" && <textarea aria-label={TEXT.field} readOnly rows={5} value={text} onFocus={(event) => event.currentTarget.select()} />}
      </fieldset>
      <fieldset>
        <legend>{TEXT.state}</legend>
        <div class="row">
          <button class="button" onClick={() => void code("state", (found, name) => ui.download(name, found, "application/json"))}>{TEXT.saveState}</button>
          <label class="button">
            {TEXT.openState}
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
          <button class="button" onClick={() => void code("html", (found, name) => ui.download(name, found, "text/html"))}>{TEXT.saveHtml}</button>
        </div>
      </fieldset>
    </>
  );
}

/** Draws the panel anew when the views have another size, or are others. */
function useViewsResized({ ui, store }: PartProps): void {
  const [, redraw] = useReducer((count: number) => count + 1, 0);
  const { name, main } = store.state.view.layout;
  useEffect(() => {
    const resized = new ResizeObserver(() => redraw(null as never));
    for (const view of ui.root.querySelectorAll(".views, [data-view]")) resized.observe(view);
    return () => resized.disconnect();
  }, [name, main]);
}

/** Two fields for the sides of a picture, pixels. */
function OwnSize({ size, onSize }: { readonly size: readonly [number, number]; onSize(size: readonly [number, number]): void }) {
  return (
    <div class="row">
      {[TEXT.width, TEXT.height].map((name, n) => (
        <label key={name} class="row">
          {name}
          <input
            type="number"
            min={1}
            max={MAX_SIDE}
            value={size[n]}
            onChange={(event) => {
              const value = Math.min(Math.max(Math.round(event.currentTarget.valueAsNumber || 1), 1), MAX_SIDE);
              onSize(n === 0 ? [value, size[1]] : [size[0], value]);
            }}
          />
        </label>
      ))}
    </div>
  );
}

/** The choices of what a picture shows, by their names for people. */
function viewChoices(props: PartProps): readonly (readonly [string, string])[] {
  const slices = PANES.map((pane) => [pane, TEXT.slice(nameOf(props, pane))] as const);
  return [["seen", TEXT.choices.seen], ["3d", TEXT.choices["3d"]], ...slices, ["all", TEXT.choices.all]];
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
  const view = shown === "all" ? undefined : ui.root.querySelector(`[data-view="${shown}"]`)?.getBoundingClientRect();
  // Of several views, and of views that are not on the screen: the area of all views.
  const area = ui.root.querySelector(".views")?.getBoundingClientRect();
  // The views make room for this very sheet, where it stands beside them: a picture is as wide as without it.
  const sheet = ui.root.querySelector(".sheet")?.getBoundingClientRect();
  const beside = area !== undefined && sheet !== undefined && sheet.right <= area.left ? area.left - sheet.left : 0;
  const widened = area !== undefined && area.width > 0 ? 1 + beside / area.width : 1;
  const ratio = window.devicePixelRatio || 1;
  const { width: wide, height: high } = view ?? area ?? { width: 1024, height: 768 };
  const [width, height] = [widened * wide * ratio, high * ratio];
  const factor = size === "2" ? 2 : 1;
  return { width: Math.min(Math.round(factor * width), MAX_SIDE), height: Math.min(Math.round(factor * height), MAX_SIDE) };
}
