// Saving the look as a preset of one's own, renaming, deleting; looks to files and from files.

import { useState } from "preact/hooks";
import type { Frame } from "../../engine/engine.ts";
import type { Look } from "../../state/state.ts";
import type { PartProps } from "../part.ts";
import { Button } from "../fields.tsx";
import { lookFromText, lookText } from "./looks.ts";
import { dropPreset, keepPreset, nameProblem, renamePreset, type OwnPreset } from "./own_presets.ts";
import { PANEL_WORDS } from "../../panel_words.ts";

const TEXT = PANEL_WORDS.ownPresetsFields;
const PICTURE_PX = 96;

interface OwnPresetsProps extends PartProps {
  readonly own: readonly OwnPreset[];
  onOwn(own: readonly OwnPreset[]): void;
  onTake(look: Look): void;
}

export function OwnPresets({ store, ui, welcome, own, onOwn, onTake }: OwnPresetsProps) {
  const [name, setName] = useState("");
  const [why, setWhy] = useState("");
  const layer = store.state.layers[ui.layer];
  if (layer === undefined) return null;
  const chosen = own.find((preset) => preset.name === layer.look.name);
  const taken = ["auto", ...welcome.presets.map((preset) => preset.name)];
  const rename = (to: string): void =>
    store.change([{ op: "replace", path: `/layers/${ui.layer}/look/name`, value: to }]);

  const attempt = (change: () => readonly OwnPreset[]): boolean => {
    try {
      onOwn(change());
      return true;
    } catch (problem) {
      ui.problem({ code: "not_kept", message: `${TEXT.notKept}: ${(problem as Error).message}`, remedy: TEXT.remedy });
      return false;
    }
  };
  const checked = (): string | null => {
    const wanted = name.trim();
    const found = nameProblem(wanted, taken);
    setWhy(found ?? "");
    return found === null ? wanted : null;
  };
  const save = async (): Promise<void> => {
    const wanted = checked();
    if (wanted === null) return;
    const composite = store.state.render.composite;
    const look = {
      ...layer.look,
      name: wanted,
      composite: typeof composite === "string" && store.state.layers.length === 1 ? composite : layer.look.composite,
      background: typeof store.state.background === "string" ? store.state.background : layer.look.background,
    };
    const operator = store.state.layers.length === 1 && typeof composite !== "string" ? { composite } : {};
    const picture = await pictureOf(ui.frames["3d"]);
    if (!attempt(() => keepPreset({ name: wanted, look, picture, ...operator }))) return;
    setName("");
    store.change([{ op: "replace", path: `/layers/${ui.layer}/look`, value: look }]);
    ui.announce(TEXT.saved(wanted));
  };
  const open = async (input: HTMLInputElement): Promise<void> => {
    const file = input.files?.[0];
    if (file === undefined) return;
    try {
      onTake(lookFromText(await file.text()));
    } catch (problem) {
      ui.problem({ code: "no_look", message: `${TEXT.notRead}: ${file.name}: ${(problem as Error).message}` });
    }
    input.value = "";
  };

  return (
    <details class="look-details">
      <summary>{TEXT.title}</summary>
      <form
        class="look-panel"
        onSubmit={(event) => {
          event.preventDefault();
          void save();
        }}
      >
        <label class="field">
          <span>{TEXT.name}</span>
          <input
            type="text"
            class="look-grow"
            value={name}
            maxLength={100}
            aria-invalid={why !== ""}
            onInput={(event) => {
              setName(event.currentTarget.value);
              setWhy("");
            }}
          />
        </label>
        {why !== "" && (
          <p role="alert" class="look-why">
            {why}
          </p>
        )}
        <div class="row">
          <button type="submit" class="button">
            {TEXT.save}
          </button>
          {chosen !== undefined && (
            <>
              <Button
                label={`${TEXT.rename} ${chosen.name}`}
                onClick={() => {
                  const wanted = checked();
                  if (wanted === null || !attempt(() => renamePreset(chosen.name, wanted))) return;
                  setName("");
                  rename(wanted);
                }}
              >
                {TEXT.rename}
              </Button>
              <Button
                label={`${TEXT.remove} ${chosen.name}`}
                onClick={() => attempt(() => dropPreset(chosen.name)) && ui.announce(TEXT.removed(chosen.name))}
              >
                {TEXT.remove}
              </Button>
            </>
          )}
        </div>
        <div class="row">
          <Button
            onClick={() => ui.download(`${layer.look.name || "look"}.json`, lookText(layer.look), "application/json")}
          >
            {TEXT.export}
          </Button>
          <label class="button look-file">
            {TEXT.import}
            <input
              type="file"
              class="hidden"
              accept=".json,application/json"
              onChange={(event) => void open(event.currentTarget)}
            />
          </label>
        </div>
      </form>
    </details>
  );
}

/** A small picture of the middle of a frame, as a data URL. */
async function pictureOf(frame: Frame | undefined): Promise<string> {
  if (frame === undefined) return "";
  const picture = await createImageBitmap(new Blob([frame.bytes], { type: `image/${frame.format}` }));
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = PICTURE_PX;
  const side = Math.min(picture.width, picture.height);
  const context = canvas.getContext("2d");
  context?.drawImage(
    picture,
    (picture.width - side) / 2,
    (picture.height - side) / 2,
    side,
    side,
    0,
    0,
    PICTURE_PX,
    PICTURE_PX,
  );
  picture.close();
  return canvas.toDataURL("image/jpeg", 0.8);
}
