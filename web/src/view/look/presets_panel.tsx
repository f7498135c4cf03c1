// Presets as small pictures of this volume; those that fit first, then all; the user's own with their names.

import { useEffect, useMemo, useReducer, useRef, useState } from "preact/hooks";
import type { Problem } from "../../engine/engine.ts";
import { axesOf, dot } from "../../input/camera.ts";
import type { Camera, Composite, Look } from "../../state/state.ts";
import type { PartProps } from "../part.ts";
import { Button } from "./fields.tsx";
import { LayerChoice } from "./function_panel.tsx";
import { chosen } from "./looks.ts";
import { OwnPresets } from "./own_presets_fields.tsx";
import { ownPresets } from "./own_presets.ts";
import { PresetPictures } from "./preset_pictures.ts";
import { PresetTiles, type Tile } from "./preset_tiles.tsx";
import { matching } from "./preset_search.ts";
import { WORDS } from "../../words.ts";

const TEXT = WORDS.presetsPanel;

/** Cosine of a turn that is hardly seen in a small picture. */
const ALIKE = 0.996;

export function PresetsPanel(props: PartProps) {
  const { store, engine, ui, welcome } = props;
  const layer = store.state.layers[ui.layer];
  const [search, setSearch] = useState("");
  const [showsAll, setShowsAll] = useState(false);
  const [own, setOwn] = useState(() => ownPresets());
  const [, redraw] = useReducer((count: number) => count + 1, 0);
  const pictures = useMemo(() => new PresetPictures(engine, ui.layer, () => redraw(null as never)), [engine, ui.layer]);
  useEffect(() => () => pictures.close(), [pictures]);
  useEffect(() => store.subscribe(() => pictures.pause()), [store, pictures]);
  const now = { camera: store.state.camera, time: layer?.time };
  const drawn = useRef(now);
  useMemo(() => (drawn.current = now), [pictures]);
  if (layer === undefined) return null;

  const isOld = drawn.current.time !== now.time || !looksAlike(drawn.current.camera, now.camera);
  const drawAnew = (): void => {
    drawn.current = now;
    pictures.clear().forEach((name) => pictures.want(name));
    redraw(null as never);
  };
  const take = (look: Look, composite?: Composite): void => {
    store.change(chosen(store.state, ui.layer, look, composite));
    ui.announce(TEXT.chosen(look.name));
  };
  const choose = async (name: string): Promise<void> => {
    try {
      take((await engine.ask("preset", { layer: ui.layer, name })).look);
    } catch (found) {
      ui.problem(found as Problem);
    }
  };
  const tiles: readonly (Tile & { fits: boolean })[] = [
    { name: "auto", description: TEXT.auto, fits: true },
    ...welcome.presets.map(({ name, description, layers }) => ({ name, description, fits: layers.includes(ui.layer) })),
  ];
  const found = matching(tiles, search);
  const fitting = found.filter(({ fits }) => fits);
  const rest = found.filter(({ fits }) => !fits);
  const ownTiles = matching(
    own.map(({ name, look, picture }) => ({ name, description: look.description || TEXT.ownPreset, picture })),
    search,
  );
  const grid = { selected: layer.look.name, pictures, onChoose: (name: string) => void choose(name) };
  return (
    <div class="look-panel">
      <LayerChoice {...props} />
      <label class="field">
        <span>{TEXT.search}</span>
        <input
          type="search"
          class="look-grow"
          value={search}
          onInput={(event) => setSearch(event.currentTarget.value)}
        />
      </label>
      {ownTiles.length > 0 && (
        <>
          <h3>{TEXT.own}</h3>
          <PresetTiles
            {...grid}
            label={TEXT.own}
            tiles={ownTiles}
            onChoose={(name) => {
              const preset = own.find((one) => one.name === name);
              if (preset !== undefined) take(preset.look, preset.composite);
            }}
          />
        </>
      )}
      {fitting.length > 0 && <PresetTiles {...grid} label={TEXT.fitting} tiles={fitting} />}
      {rest.length > 0 && (
        <details
          class="look-details"
          open={showsAll || search !== ""}
          onToggle={(event) => search === "" && setShowsAll(event.currentTarget.open)}
        >
          <summary>{TEXT.all(rest.length)}</summary>
          {(showsAll || search !== "") && <PresetTiles {...grid} label={TEXT.all(rest.length)} tiles={rest} />}
        </details>
      )}
      {found.length + ownTiles.length === 0 && <p class="dim">{TEXT.none}</p>}
      {store.state.layers.length > 1 && layer.look.composite !== "over" && <p class="look-small">{TEXT.alone}</p>}
      {isOld && (
        <>
          <p class="dim look-small">{TEXT.old}</p>
          <Button onClick={drawAnew}>{TEXT.redraw}</Button>
        </>
      )}
      <OwnPresets {...props} own={own} onOwn={setOwn} onTake={take} />
    </div>
  );
}

/** Whether two cameras give the same small pictures: these are fitted to the whole, so only directions count. */
function looksAlike(a: Camera, b: Camera): boolean {
  const [one, other] = [axesOf(a), axesOf(b)];
  return Math.min(dot(one.back, other.back), dot(one.up, other.up)) > ALIKE;
}
