// What stands over a slice: crosshair, measures, names, window, letters, scale bar.

import { useLayoutEffect, useRef, useState } from "preact/hooks";

import type { Frame } from "../../engine/engine.ts";
import type { Pane } from "../../state/state.ts";
import { WORDS } from "../../words.ts";
import { shortNumber } from "../descriptions.ts";
import { CropOnSlice } from "../overlay3d/crop_on_slice.tsx";
import type { CssSize, PartProps } from "../part.ts";
import { CrosshairLine } from "./crosshair.tsx";
import type { Drawing } from "./drawing.ts";
import { textsThatFit } from "./fitting.ts";
import { barLength, othersOf, type SliceFrame } from "./geometry.ts";
import { numberedSlice } from "./numbers.ts";
import { MeasuresOnSlice } from "./measures.tsx";
import { nameOf, PANE_COLORS } from "./panes.ts";
import { WindowMenu, windowText } from "./window_menu.tsx";

const TEXT = WORDS.slices;

export function SliceOverlay(props: PartProps & { pane: Pane; frame: Frame; on: SliceFrame; drawing: Drawing }) {
  const { pane, on, store, welcome } = props;
  const { slices, overlays } = store.state.view;
  const { geometry } = on;
  const { letters } = geometry;
  const unit = welcome.volumes[0]?.unit ?? TEXT.units;
  const isTilted = slices.normals?.[pane] !== undefined;
  const numbered = numberedSlice(props, pane);
  const name = [
    isTilted ? TEXT.tilted(nameOf(props, pane)) : nameOf(props, pane),
    `${shortNumber(geometry.position, 4)} ${unit}${numbered === null ? "" : ` · ${numbered.number}/${numbered.count}`}`,
    ...(slices.thickness > 0 ? [TEXT.slab(TEXT.slabs[slices.slab], `${shortNumber(slices.thickness)} ${unit}`)] : []),
  ];
  const room = useRef<HTMLDivElement>(null);
  const texts = textsThatFit(useRoom(room), name, windowText(props, props.frame));
  const showsLetters = overlays.letters && letters !== null;
  return (
    <>
      <svg class="over" aria-hidden={false}>
        {overlays.crosshair && othersOf(pane).map((other) => <CrosshairLine key={other} {...props} on={on} other={other} />)}
        {overlays.crop_box && <CropOnSlice {...props} on={on} />}
        <MeasuresOnSlice {...props} on={on} drawing={props.drawing} />
      </svg>
      <div class="texts" ref={room}>
        {texts.name.length > 0 && <div class="corner pill" style={{ color: PANE_COLORS[pane] }}>{texts.name.join("\n")}</div>}
        {texts.window !== null && <WindowMenu {...props} text={texts.window} />}
        {showsLetters && texts.sideLetters && (
          <>
            <Letter x="4px" y="50%" from="0 -50%">{letters.left}</Letter>
            <Letter x="calc(100% - 4px)" y="50%" from="-100% -50%">{letters.right}</Letter>
          </>
        )}
        {showsLetters && texts.endLetters && (
          <>
            <Letter x="50%" y="6px" from="-50% 0">{letters.top}</Letter>
            <Letter x="50%" y="calc(100% - 6px)" from="-50% -100%">{letters.bottom}</Letter>
          </>
        )}
        {overlays.scale_bar && texts.scaleBar && <ScaleBar on={on} unit={unit} />}
      </div>
    </>
  );
}

/** A direction's letter, at a place of the view, moved by shares of its own size. */
function Letter(props: { readonly x: string; readonly y: string; readonly from: string; readonly children: string }) {
  return <span class="pill letter" aria-hidden="true" style={{ left: props.x, top: props.y, translate: props.from }}>{props.children}</span>;
}

/** Size of the part of the view that no group of controls lies over, CSS pixels; nothing until it is known. */
function useRoom(element: { readonly current: HTMLElement | null }): CssSize {
  const [size, setSize] = useState<CssSize>({ width: 0, height: 0 });
  useLayoutEffect(() => {
    if (element.current === null) return undefined;
    const observer = new ResizeObserver(([entry]) => entry && setSize(entry.contentRect));
    observer.observe(element.current);
    return () => observer.disconnect();
  }, []);
  return size;
}

function ScaleBar({ on, unit }: { readonly on: SliceFrame; readonly unit: string }) {
  const { geometry, size, width } = on;
  const perCss = (geometry.pixel * width) / size.width;
  const bar = barLength(perCss * size.width * 0.3);
  return (
    <div class="corner low pill scale" aria-hidden="true">
      {`${bar} ${unit}`}
      <span style={{ width: `${bar / perCss}px` }} />
    </div>
  );
}
