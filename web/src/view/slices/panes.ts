// Names and colours of the slices.

import type { Pane } from "../../state/state.ts";
import { WORDS } from "../../words.ts";
import type { PartProps } from "../part.ts";

export const PANE_COLORS: Readonly<Record<Pane, string>> = { z: "#ff6b6b", y: "#6bd46b", x: "#6ba8ff" };

/** The name of a plane: radiology's for bodies, else the axis across it. */
export const nameOf = ({ welcome }: Pick<PartProps, "welcome">, pane: Pane): string => (welcome.volumes[0]?.is_anatomical ? WORDS.planes[pane] : pane);
