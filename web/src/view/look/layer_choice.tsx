// The layer that the panels of the look are about.

import { PANEL_WORDS } from "../../panel_words.ts";
import { Choice } from "../fields.tsx";
import type { PartProps } from "../part.ts";

/** A choice of the layer that the panels of the look are about, where there are several. */
export function LayerChoice({ store, ui }: PartProps) {
  const { layers } = store.state;
  if (layers.length < 2) return null;
  return (
    <Choice
      label={PANEL_WORDS.functionPanel.layer}
      value={String(ui.layer)}
      options={layers.map(({ name }, index) => [String(index), name] as const)}
      onChoose={(value) => ui.setLayer(Number(value))}
    />
  );
}
