// Operations between two states: what a page changed while it had no connection.

import { pathOf, type Operation } from "./patch.ts";

/** Operations that turn one JSON document into another. A list that differs is replaced as a whole, an object by fields. */
export function differences(before: unknown, after: unknown, ...steps: readonly string[]): Operation[] {
  if (Object.is(before, after)) return [];
  const path = pathOf(...steps);
  if (!isObject(before) || !isObject(after)) {
    return isSame(before, after) ? [] : [{ op: "replace", path, value: after }];
  }
  const removed = Object.keys(before).filter((name) => !Object.hasOwn(after, name));
  return [
    ...removed.map((name): Operation => ({ op: "remove", path: pathOf(...steps, name) })),
    ...Object.entries(after).flatMap(([name, value]): Operation[] =>
      Object.hasOwn(before, name)
        ? differences(before[name], value, ...steps, name)
        : [{ op: "add", path: pathOf(...steps, name), value }],
    ),
  ];
}

function isObject(value: unknown): value is Readonly<Record<string, unknown>> {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

function isSame(one: unknown, other: unknown): boolean {
  if (Array.isArray(one) && Array.isArray(other)) {
    return one.length === other.length && one.every((value, place) => isSame(value, other[place]));
  }
  if (isObject(one) && isObject(other)) return differences(one, other).length === 0;
  return Object.is(one, other);
}
