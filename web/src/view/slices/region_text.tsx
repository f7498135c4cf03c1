// Mean and deviation of the values in a region, which the session works out; each region is asked for once.

import { useEffect, useState } from "preact/hooks";

import type { Questions } from "../../engine/engine.ts";
import type { Measure } from "../../state/state.ts";
import { WORDS } from "../../words.ts";
import { shortNumber } from "../descriptions.ts";
import type { PartProps } from "../part.ts";

/** Statistics of the values of a layer in a region; null where it has no values there. */
export type RegionFacts = NonNullable<Questions["region"]["answer"]["layers"][number]>;

const known = new WeakMap<readonly unknown[], Map<string, Promise<RegionFacts | null>>>();

/** Statistics of the first layer in a region, at the time of its series; null also where nothing answers, until asked again. */
export function regionFacts({ engine, store, welcome }: PartProps, { points }: Measure): Promise<RegionFacts | null> {
  // Other data can be opened under the same regions.
  const key = `${welcome.fingerprint} ${store.state.layers[0]?.time ?? 0}`;
  const answers = known.get(points) ?? new Map<string, Promise<RegionFacts | null>>();
  known.set(points, answers);
  const found = answers.get(key) ?? engine.ask("region", { points }).then(({ layers }) => layers[0] ?? null, () => {
    answers.delete(key);
    return null;
  });
  answers.set(key, found);
  return found;
}

export function textOfRegion({ mean, sd }: RegionFacts, unit: string): string {
  return WORDS.measures.mean(shortNumber(mean, 4), shortNumber(sd, 3), unit);
}

/** Milliseconds for which a region must not move before it is asked for. */
const SETTLED_MS = 150;

export function useRegionFacts(props: PartProps, measure: Measure): RegionFacts | null {
  const { points } = measure;
  const time = props.store.state.layers[0]?.time ?? 0;
  const [facts, setFacts] = useState<{ points: unknown; time: number; facts: RegionFacts | null } | null>(null);
  useEffect(() => {
    let isGone = false;
    const timer = setTimeout(() => {
      void regionFacts(props, measure).then((found) => !isGone && setFacts({ points, time, facts: found }));
    }, SETTLED_MS);
    return () => {
      isGone = true;
      clearTimeout(timer);
    };
  }, [points, time, props.welcome.fingerprint]);
  return facts?.points === points && facts.time === time ? facts.facts : null;
}

export function RegionText(props: PartProps & { readonly measure: Measure; readonly x: number; readonly y: number }) {
  const facts = useRegionFacts(props, props.measure);
  if (facts === null) return null;
  return <text x={props.x} y={props.y}>{textOfRegion(facts, props.welcome.volumes[0]?.value_unit ?? "")}</text>;
}
