// The list of the scene's volumes and shapes: their visibility and opacity, and which one the panels of the look are about.

import { set } from "../../state/patch.ts";
import { withoutLayer, withoutShape } from "../open/index.ts";
import type { PartProps } from "../part.ts";
import { Button, Switch, NumberField } from "../fields.tsx";
import { isSolo, soloLayer } from "./layers.ts";
import { titleOf } from "./preset_kinds.ts";
import { Ramp } from "./ramp.tsx";
import { PANEL_WORDS } from "../../panel_words.ts";

const TEXT = PANEL_WORDS.layersPanel;

export function LayersPanel({ store, ui }: PartProps) {
  const { layers, geometry } = store.state;
  return (
    <>
      <ul class="look-list" aria-label={TEXT.list}>
        {layers.map((layer, index) => (
          <li key={index} class="look-layer" data-chosen={index === ui.layer && layers.length > 1}>
            <div class="row look-nowrap">
              <input
                type="checkbox"
                aria-label={TEXT.shown(layer.name)}
                title={TEXT.shown(layer.name)}
                checked={layer.visible}
                onChange={(event) => store.change([set(event.currentTarget.checked, "layers", index, "visible")])}
              />
              <Ramp layer={layer} />
              <input
                type="text"
                class="look-grow"
                aria-label={TEXT.name(index)}
                value={layer.name}
                maxLength={200}
                onChange={(event) => {
                  const name = event.currentTarget.value.trim();
                  if (name === "") event.currentTarget.value = layer.name;
                  else store.change([set(name, "layers", index, "name")]);
                }}
              />
              {layers.length > 1 && (
                <Button
                  label={TEXT.soloThis(layer.name)}
                  pressed={isSolo(layers, index)}
                  onClick={() => store.change(soloLayer(layers, index))}
                >
                  {TEXT.solo}
                </Button>
              )}
            </div>
            <NumberField
              isBounded
              label={layers.length > 1 ? TEXT.opacityOf(layer.name) : TEXT.opacity}
              shown={TEXT.opacity}
              min={0}
              max={1}
              step={0.01}
              value={layer.opacity}
              onInput={(value) => store.change([set(value, "layers", index, "opacity")], `opacity of layer ${index}`)}
              onSettle={() => store.settle()}
            />
            {layers.length > 1 && (
              <div class="row open-apart">
                <label class="row look-check">
                  <input
                    type="radio"
                    name="look-layer"
                    aria-label={TEXT.editThis(layer.name)}
                    checked={index === ui.layer}
                    onChange={() => ui.setLayer(index)}
                  />
                  <span>{TEXT.edit}</span>
                  <span class="dim">{TEXT.look(titleOf(layer.look.name))}</span>
                </label>
                <Button label={TEXT.removeThis(layer.name)} onClick={() => store.change(withoutLayer(store.state, index))}>
                  {TEXT.remove}
                </Button>
              </div>
            )}
          </li>
        ))}
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
