// The strip of looks at the foot: large tiles of this volume as it is seen now. The pointer shows one, a click keeps it.

import { useEffect, useMemo, useReducer } from "preact/hooks";
import type { PartProps } from "../part.ts";
import { PANEL_WORDS } from "../../panel_words.ts";
import { WORDS } from "../../words.ts";
import { LayerChoice } from "./layer_choice.tsx";
import { LookPreview } from "./look_preview.ts";
import { isOffered, titleOf } from "./preset_kinds.ts";
import { PresetTiles, type Tile } from "./preset_tiles.tsx";
import { usePictures } from "./use_pictures.ts";

const TEXT = PANEL_WORDS.presetsPanel;

export function LooksStrip(props: PartProps & { onAll(): void }) {
  const { store, engine, ui, welcome, onAll } = props;
  const layer = store.state.layers[ui.layer];
  const [, redraw] = useReducer((count: number) => count + 1, 0);
  const pictures = usePictures(props, () => redraw(null as never));
  const preview = useMemo(() => new LookPreview(store, engine, ui.layer, ui.problem), [store, engine, ui.layer]);
  useEffect(() => () => preview.leave(), [preview]);
  if (layer === undefined) return null;
  const volume = welcome.volumes[ui.layer];
  const tiles: readonly Tile[] = [
    { name: "auto", title: titleOf("auto"), description: TEXT.auto },
    ...welcome.presets
      .filter((preset) => isOffered(preset, ui.layer, volume))
      .map(({ name, description }) => ({ name, title: titleOf(name), description })),
  ];
  const keep = async (name: string): Promise<void> => {
    try {
      preview.keep(await preview.lookOf(name));
      ui.announce(TEXT.chosen(titleOf(name)));
    } catch (problem) {
      ui.problem(problem as never);
    }
  };
  return (
    <section class="looks float" data-panel="presets" aria-label={WORDS.sheets.presets}>
      <div class="body">
        <LayerChoice {...props} />
        <PresetTiles
          label={TEXT.fitting}
          tiles={tiles}
          selected={preview.chosenName}
          pictures={pictures}
          onChoose={(name) => void keep(name)}
          onRest={(name) => preview.rest(name)}
          onLeave={() => preview.leave()}
        />
        <button class="button looks-all" data-opens="looks" onClick={onAll}>{TEXT.allLooks}</button>
      </div>
    </section>
  );
}
