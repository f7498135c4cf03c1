// The knobs of a layer's transfer function: they turn from the function that was there when they were taken.

import { useRef, useState } from "preact/hooks";

import { set } from "../../state/patch.ts";
import type { TransferFunction } from "../../state/state.ts";
import { WORDS } from "../../words.ts";
import type { PartProps } from "../part.ts";
import type { Range } from "./curves.ts";
import { NumberField } from "../fields.tsx";
import { STILL, turned, type Knobs } from "./knobs.ts";

const TEXT = WORDS.knobs;
const NAMES = ["reveal", "soften", "through"] as const;

export function KnobFields({ store, ui, curves, usual }: PartProps & { readonly curves: TransferFunction; readonly usual: Range }) {
  const [knobs, setKnobs] = useState<Knobs>(STILL);
  const [base, made] = [useRef(curves), useRef(curves)];
  // Another change, such as a preset or undo: the knobs begin anew from there.
  const isOwn = curves === made.current;
  if (!isOwn) base.current = made.current = curves;
  const now = isOwn ? knobs : STILL;
  const turn = (name: keyof Knobs, percent: number): void => {
    const next = { ...now, [name]: percent / 100 };
    made.current = turned(base.current, next, usual);
    setKnobs(next);
    store.change([set(made.current, "layers", ui.layer, "look", "transfer_function")], `knob ${name}`);
  };
  return (
    <div class="look-knobs">
      {NAMES.map((name) => (
        <NumberField
          isBounded
          key={name}
          label={TEXT[name]}
          unit="%"
          min={name === "through" ? 0 : -100}
          max={100}
          step={1}
          decimals={0}
          value={100 * now[name]}
          onInput={(percent) => turn(name, percent)}
          onSettle={() => store.settle()}
        />
      ))}
    </div>
  );
}
