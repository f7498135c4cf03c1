// Pictures of presets that follow the camera: drawn anew when it has been still for a while.

import { useEffect, useMemo, useRef } from "preact/hooks";
import { axesOf, dot } from "../../input/camera.ts";
import type { Camera } from "../../state/state.ts";
import type { PartProps } from "../part.ts";
import { PresetPictures } from "./preset_pictures.ts";

/** Cosine of a turn that is hardly seen in a small picture. */
const ALIKE = 0.996;
/** Milliseconds without a change of the camera or the time after which old pictures are drawn anew. */
const IDLE_MS = 3000;

export function usePictures({ engine, store, ui }: PartProps, onChange: () => void): PresetPictures {
  const pictures = useMemo(() => new PresetPictures(engine, ui.layer, onChange), [engine, ui.layer]);
  useEffect(() => () => pictures.close(), [pictures]);
  useEffect(() => store.subscribe(() => pictures.pause()), [store, pictures]);
  const camera = store.state.camera;
  const time = store.state.layers[ui.layer]?.time;
  const drawn = useRef({ camera, time });
  useMemo(() => (drawn.current = { camera, time }), [pictures]);
  useEffect(() => {
    if (drawn.current.time === time && looksAlike(drawn.current.camera, camera)) return undefined;
    const timer = setTimeout(() => {
      drawn.current = { camera, time };
      pictures.refresh();
    }, IDLE_MS);
    return () => clearTimeout(timer);
  }, [pictures, camera, time]);
  return pictures;
}

/** Whether two cameras give the same small pictures: these are fitted to the whole, so only directions count. */
function looksAlike(a: Camera, b: Camera): boolean {
  const [one, other] = [axesOf(a), axesOf(b)];
  return Math.min(dot(one.back, other.back), dot(one.up, other.up)) > ALIKE;
}
