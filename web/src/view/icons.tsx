// Icons as lines on a grid of 20; each stands beside a name, or has one for screen readers.

const PATHS = {
  undo: "M8 5 4 9l4 4M4 9h8a4 4 0 0 1 0 8H9",
  redo: "M12 5l4 4-4 4M16 9H8a4 4 0 0 0 0 8h3",
  fit: "M4 8V4h4M16 8V4h-4M4 12v4h4M16 12v4h-4M8 8h4v4H8z",
  turn: "M15 6a7 3 0 1 0 1 4M16 3v4h-4M10 10v7",
  window: "M10 3a7 7 0 1 0 0 14zM10 3a7 7 0 0 1 0 14",
  distance: "M3 17 17 3M3 13v4h4M17 7V3h-4",
  angle: "M16 16H4L14 4M9 16a6 6 0 0 0-1.5-4",
  share: "M10 12V3M6 7l4-4 4 4M4 11v6h12v-6",
  help: "M7.5 7.5a2.5 2.5 0 1 1 3.5 2.3c-.8.4-1 .9-1 1.7M10 14.6v.1M10 18a8 8 0 1 0 0-16 8 8 0 0 0 0 16z",
  light: "M10 2v2M10 16v2M2 10h2M16 10h2M4.5 4.5l1.4 1.4M14.1 14.1l1.4 1.4M15.5 4.5l-1.4 1.4M5.9 14.1l-1.4 1.4M10 6.5a3.5 3.5 0 1 0 0 7 3.5 3.5 0 0 0 0-7z",
  dark: "M16 12A7 7 0 0 1 8 4a7 7 0 1 0 8 8z",
  panels: "M3 4h14v12H3zM12 4v12",
} as const;

export type IconName = keyof typeof PATHS;

export function Icon({ name }: { readonly name: IconName }) {
  return (
    <svg viewBox="0 0 20 20" aria-hidden="true">
      <path d={PATHS[name]} />
    </svg>
  );
}
