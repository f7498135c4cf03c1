// Presets as small pictures of this volume; those that fit first, then all; the user's own with their names.

import { useReducer, useState } from "preact/hooks";
import type { Problem } from "../../engine/engine.ts";
import type { Composite, Look } from "../../state/state.ts";
import type { PartProps } from "../part.ts";
import { LayerChoice } from "./layer_choice.tsx";
import { chosen } from "./looks.ts";
import { OwnPresets } from "./own_presets_fields.tsx";
import { ownPresets } from "./own_presets.ts";
import { isOffered, titleOf } from "./preset_kinds.ts";
import { PresetTiles, type Tile } from "./preset_tiles.tsx";
import { matching } from "./preset_search.ts";
import { usePictures } from "./use_pictures.ts";
import { PANEL_WORDS } from "../../panel_words.ts";

const TEXT = PANEL_WORDS.presetsPanel;

export function PresetsPanel(props: PartProps) {
  const { store, engine, ui, welcome } = props;
  const layer = store.state.layers[ui.layer];
  const [search, setSearch] = useState("");
  const [showsAll, setShowsAll] = useState(false);
  const [own, setOwn] = useState(() => ownPresets());
  const [, redraw] = useReducer((count: number) => count + 1, 0);
  const pictures = usePictures(props, () => redraw(null as never));
  if (layer === undefined) return null;

  const take = (look: Look, composite?: Composite): void => {
    store.change(chosen(store.state, ui.layer, look, composite));
    ui.announce(TEXT.chosen(titleOf(look.name)));
  };
  const choose = async (name: string): Promise<void> => {
    try {
      take((await engine.ask("preset", { layer: ui.layer, name })).look);
    } catch (found) {
      ui.problem(found as Problem);
    }
  };
  const tiles: readonly (Tile & { fits: boolean })[] = [
    { name: "auto", title: titleOf("auto"), description: TEXT.auto, fits: true },
    ...welcome.presets.map((preset) => {
      const { name, description } = preset;
      return { name, title: titleOf(name), description, fits: isOffered(preset, ui.layer, welcome.volumes[ui.layer]) };
    }),
  ];
  const found = matching(tiles, search);
  const fitting = found.filter(({ fits }) => fits);
  const rest = found.filter(({ fits }) => !fits);
  const ownTiles = matching(
    own.map(({ name, look, picture }) => ({ name, title: name, description: look.description || TEXT.ownPreset, picture })),
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
      <OwnPresets {...props} own={own} onOwn={setOwn} onTake={take} />
    </div>
  );
}
