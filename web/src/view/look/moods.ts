// Moods of light: settings of the shading that go together, for one click.

import type { Light, Shading, Vec3 } from "../../state/state.ts";
import { DEFAULT_LIGHTS, DEFAULT_SHADING } from "./looks.ts";

export type MoodName = "soft" | "studio" | "dramatic";

interface Mood {
  readonly shading: Pick<Shading, "ambient" | "diffuse" | "specular" | "specular_power" | "ambient_occlusion" | "shadow">;
  /** Direction of the first light. */
  readonly direction: Vec3;
}

/** Found by eye on a CT of bones, a CT of skin and an MRI of a head (2026-11-28). */
export const MOODS: Readonly<Record<MoodName, Mood>> = {
  soft: {
    shading: { ambient: 0.5, diffuse: 0.7, specular: 0.06, specular_power: 10, ambient_occlusion: 0.75, shadow: 0 },
    direction: [-0.2, 0.6, 1],
  },
  studio: {
    shading: { ambient: 0.22, diffuse: 1, specular: 0.25, specular_power: 16, ambient_occlusion: 0.35, shadow: 0 },
    direction: [-0.55, 0.65, 1],
  },
  dramatic: {
    shading: { ambient: 0.08, diffuse: 1.15, specular: 0.4, specular_power: 30, ambient_occlusion: 0.6, shadow: 0.85 },
    direction: [-1, 0.55, 0.45],
  },
};

/** A shading in a mood; all that a mood does not set stays. */
export function inMood(shading: Shading | null, name: MoodName): Shading {
  const { shading: fields, direction } = MOODS[name];
  const before = shading ?? DEFAULT_SHADING;
  const [first, ...others] = before.lights.length > 0 ? before.lights : DEFAULT_LIGHTS;
  return { ...before, ...fields, lights: [{ ...(first as Light), direction }, ...others] };
}

/** The mood that a shading is in, or null. */
export function moodOf(shading: Shading | null): MoodName | null {
  if (shading === null) return null;
  const first = (shading.lights.length > 0 ? shading.lights : DEFAULT_LIGHTS)[0];
  const names = Object.keys(MOODS) as MoodName[];
  return (
    names.find((name) => {
      const { shading: fields, direction } = MOODS[name];
      const isLit = direction.every((part, axis) => Math.abs(part - (first?.direction[axis] ?? NaN)) < 1e-6);
      return isLit && Object.entries(fields).every(([field, value]) => shading[field as keyof Mood["shading"]] === value);
    }) ?? null
  );
}
