// A list of presets as tiles, one of which is chosen. Arrows go from tile to tile, Enter and Space choose.

import { useEffect, useRef, useState } from "preact/hooks";
import type { PresetPictures } from "./preset_pictures.ts";
import { PANEL_WORDS } from "../../panel_words.ts";

const TEXT = PANEL_WORDS.presetTiles;

export interface Tile {
  readonly name: string;
  /** The name for people. */
  readonly title: string;
  readonly description: string;
  /** Address of the picture, where it is not drawn by the engine. */
  readonly picture?: string;
}

interface PresetTilesProps {
  readonly label: string;
  readonly tiles: readonly Tile[];
  readonly selected: string;
  readonly pictures: PresetPictures;
  onChoose(name: string): void;
  /** Called when the pointer comes to a tile, and when it leaves the tiles. */
  onRest?(name: string): void;
  onLeave?(): void;
}

export function PresetTiles({ label, tiles, selected, pictures, onChoose, onRest, onLeave }: PresetTilesProps) {
  const list = useRef<HTMLDivElement>(null);
  const [focused, setFocused] = useState<string | null>(null);
  // One tile is in the tab order: the one that had the focus, the chosen one, or the first.
  const entry = [focused, selected].find((name) => tiles.some((tile) => tile.name === name)) ?? tiles[0]?.name;
  const names = tiles.map(({ name }) => name).join("\n");
  useEffect(() => {
    const seen = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) {
        const name = (target as HTMLElement).dataset["name"] ?? "";
        if (isIntersecting) pictures.want(name);
        else pictures.leave(name);
      }
    });
    list.current?.querySelectorAll("[data-drawn]").forEach((tile) => seen.observe(tile));
    return () => seen.disconnect();
  }, [pictures, names]);

  const onKeyDown = (event: KeyboardEvent, index: number): void => {
    const all = [...(list.current?.querySelectorAll<HTMLElement>("[role=option]") ?? [])];
    const columns = Math.max(
      1,
      all.findIndex((tile) => tile.offsetTop > (all[0]?.offsetTop ?? 0)),
    );
    const row = all.length > columns ? columns : 1;
    const steps: Partial<Record<string, number>> = {
      ArrowLeft: index - 1,
      ArrowRight: index + 1,
      ArrowUp: index - row,
      ArrowDown: index + row,
      Home: 0,
      End: all.length - 1,
    };
    const target = steps[event.key];
    if (event.key === "Enter" || event.key === " ") onChoose(tiles[index]?.name ?? "");
    else if (target !== undefined) all[Math.max(0, Math.min(all.length - 1, target))]?.focus();
    else return;
    event.preventDefault();
    event.stopPropagation();
  };

  return (
    <div class="look-tiles" role="listbox" aria-label={label} ref={list} onPointerLeave={onLeave}>
      {tiles.map(({ name, title, description, picture }, index) => {
        const address = picture ?? pictures.get(name);
        const reason = pictures.reason(name);
        const about = reason === undefined ? description : `${description} ${TEXT.noPicture}: ${reason}`;
        return (
          <div
            key={name}
            class="look-tile"
            role="option"
            aria-selected={name === selected}
            aria-label={`${title}: ${about}`}
            title={about}
            tabIndex={name === entry ? 0 : -1}
            data-name={name}
            data-drawn={picture === undefined ? true : undefined}
            onPointerEnter={(event) => event.pointerType === "mouse" && onRest?.(name)}
            onClick={() => onChoose(name)}
            onFocus={() => setFocused(name)}
            onKeyDown={(event) => onKeyDown(event, index)}
          >
            {address ? (
              <img src={address} alt="" width={96} height={96} />
            ) : (
              <span class="look-blank">{reason !== undefined && TEXT.noPicture}</span>
            )}
            <span class="look-name">{title}</span>
          </div>
        );
      })}
    </div>
  );
}
