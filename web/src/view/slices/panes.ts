// Names and colours of the slices.

import type { Pane } from "../../state/state.ts";
import type { PartProps } from "../part.ts";

export const PANE_COLORS: Readonly<Record<Pane, string>> = { z: "#ff6b6b", y: "#6bd46b", x: "#6ba8ff" };
/** Names of planes: radiology's for bodies, else the axis across the plane. */
const BODY: Readonly<Record<Pane, string>> = { z: "Axial", y: "Coronal", x: "Sagittal" };

export const nameOf = ({ welcome }: Pick<PartProps, "welcome">, pane: Pane): string => (welcome.volumes[0]?.is_anatomical ? BODY[pane] : pane);
