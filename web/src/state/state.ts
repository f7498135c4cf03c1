// The state of the viewer: one JSON document, a scene as `wavesplat.Scene.save` writes it with one field more, `view`.
// Its types are written from the tables of `crates/document`; here are names for parts of them.

import type { OVERLAYS, PANES, Render, SLICE_COLORS, TransferFunction, ViewerState } from "./document.generated.ts";

export * from "./document.generated.ts";

export type Color = NonNullable<ViewerState["background"]>;
/** Point of an opacity curve, [value, opacity 0..1]; values ascend. */
export type OpacityPoint = TransferFunction["opacity"][number];
/** Point of a colour curve, [value, red, green, blue], colours 0..1; values ascend. */
export type ColorPoint = TransferFunction["color"][number];
export type Clip = ViewerState["clip"][number];
export type Composite = NonNullable<Render["composite"]>;
export type Pane = (typeof PANES)[number];
export type ViewName = "3d" | Pane;
export type SliceColors = (typeof SLICE_COLORS)[number];
export type Overlay = (typeof OVERLAYS)[number];
