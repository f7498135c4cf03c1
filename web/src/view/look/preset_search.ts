// The search for presets.

/** Presets that contain all words: presets with all in the name first, and otherwise in the order given. */
export function matching<T extends { readonly name: string; readonly title?: string; readonly description: string }>(
  presets: readonly T[],
  search: string,
): T[] {
  const words = search
    .toLowerCase()
    .split(/[\s_-]+/)
    .filter((word) => word !== "");
  const has = (text: string): boolean => words.every((word) => text.toLowerCase().includes(word));
  const isNamed = ({ name, title = "" }: T): boolean => has(`${name} ${title}`);
  const found = presets.filter(({ name, title = "", description }) => has(`${name} ${title} ${description}`));
  return words.length === 0
    ? found
    : [...found.filter(isNamed), ...found.filter((one) => !isNamed(one))];
}
