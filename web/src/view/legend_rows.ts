// The rows of a legend that there is room for.

interface LegendRow {
  readonly key: string;
  readonly isShown: boolean;
}

/**
 * The rows that there is room for, in their order: what is shown before what is hidden, as in saved pictures. `touched`: keys of
 * rows that were clicked, which stay, so that a click does not move the row from under the pointer.
 */
export function chosenRows<R extends LegendRow>(rows: readonly R[], most: number, touched: ReadonlySet<string>): R[] {
  const rank = (row: R): number => (touched.has(row.key) ? 0 : row.isShown ? 1 : 2);
  const chosen = new Set([...rows].sort((a, b) => rank(a) - rank(b)).slice(0, most));
  return rows.filter((row) => chosen.has(row));
}
