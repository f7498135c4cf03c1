// The list of the scene's volumes and shapes: a row of settings for each volume, and whether shapes are shown.

import { set } from "../../state/patch.ts";
import { withoutShape } from "../open/index.ts";
import type { PartProps } from "../part.ts";
import { Button, Switch } from "../fields.tsx";
import { LayerListRow, useRows } from "./layer_row.tsx";
import { PANEL_WORDS } from "../../panel_words.ts";

const TEXT = PANEL_WORDS.layersPanel;

export function LayersPanel(props: PartProps) {
  const { store, ui } = props;
  const { layers, geometry } = store.state;
  const rows = useRows(props);
  return (
    <>
      <ul class="look-list look-layers" aria-label={TEXT.list}>
        {layers.map((layer, index) => <LayerListRow key={`${index} ${layer.volume.id ?? ""}`} {...props} index={index} layer={layer} rows={rows} />)}
      </ul>
      <div class="row"><Button onClick={() => ui.opener.show(true)}>{TEXT.add}</Button></div>
      {geometry.length > 0 && (
        <ul class="look-list" aria-label={TEXT.shapes}>
          {geometry.map(({ kind, name, count, visible }, index) => (
            <li key={index} class="row open-apart">
              <Switch
                label={name}
                note={`${kind} · ${count}`}
                on={visible}
                onToggle={(on) => store.change([set(on, "geometry", index, "visible")])}
              />
              <Button label={TEXT.removeThis(name)} onClick={() => store.change(withoutShape(index))}>{TEXT.remove}</Button>
            </li>
          ))}
        </ul>
      )}
    </>
  );
}
