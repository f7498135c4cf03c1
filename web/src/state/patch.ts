// JSON Patch (RFC 6902), the part that is needed: `add`, `replace` and `remove`. Merge patches (RFC 7386) cannot set null,
// and replace lists as a whole. `crates/document/src/patch.rs` is the twin.

export type Operation =
  | { readonly op: "add" | "replace"; readonly path: string; readonly value: unknown }
  | { readonly op: "remove"; readonly path: string };

/** The document with all operations applied, in order. Parts that they do not touch are shared with the old document. */
export function patched<T>(document: T, operations: readonly Operation[]): T {
  let changed: unknown = document;
  operations.forEach((operation, number) => {
    const what = `patch: operations[${number}]: '${operation.path}'`;
    const value = operation.op === "remove" ? undefined : operation.value;
    changed = done(changed, operation.op, stepsOf(operation.path, what), value, what);
  });
  return changed as T;
}

/**
 * The operations as the session reads them: JSON writes -0 as 0, and both ends should hold the same numbers. Values
 * without -0 are returned as they are, since what is drawn anew is decided by identity.
 */
export function asSent(operations: readonly Operation[]): readonly Operation[] {
  return operations.map((operation) => {
    if (operation.op === "remove") return operation;
    const value = withoutMinusZero(operation.value);
    return Object.is(value, operation.value) ? operation : { ...operation, value };
  });
}

function withoutMinusZero(value: unknown): unknown {
  if (Object.is(value, -0)) return 0;
  if (typeof value !== "object" || value === null) return value;
  const inner = Object.entries(value).map(([name, one]) => [name, one, withoutMinusZero(one)] as const);
  if (inner.every(([, before, after]) => Object.is(before, after))) return value;
  if (Array.isArray(value)) return inner.map(([, , after]) => after);
  return Object.fromEntries(inner.map(([name, , after]) => [name, after]));
}

/** A path of RFC 6901 from its steps. */
export function pathOf(...steps: readonly (string | number)[]): string {
  return steps.map((step) => `/${String(step).replaceAll("~", "~0").replaceAll("/", "~1")}`).join("");
}

/** The operation that sets a field, whether it is there or not. */
export function set(value: unknown, ...steps: readonly (string | number)[]): Operation {
  return { op: typeof steps.at(-1) === "number" ? "replace" : "add", path: pathOf(...steps), value };
}

function stepsOf(path: string, what: string): string[] {
  if (path !== "" && !path.startsWith("/")) throw new Error(`${what}: field 'path' must be '' or begin with '/'`);
  return path
    .split("/")
    .slice(1)
    .map((step) => step.replaceAll("~1", "/").replaceAll("~0", "~"));
}

function done(inside: unknown, op: Operation["op"], steps: readonly string[], value: unknown, what: string): unknown {
  const [step, ...rest] = steps;
  if (step === undefined) {
    if (op === "remove") throw new Error(`${what}: the whole document cannot be removed`);
    return value;
  }
  if (Array.isArray(inside)) return doneInList([...inside], op, step, rest, value, what);
  if (typeof inside !== "object" || inside === null) throw new Error(`${what}: before '${step}' stands no object`);
  const fields = inside as Record<string, unknown>;
  if ((rest.length > 0 || op !== "add") && !Object.hasOwn(fields, step)) {
    throw new Error(`${what}: there is no field '${step}'`);
  }
  if (rest.length === 0 && op === "remove") {
    return Object.fromEntries(Object.entries(fields).filter(([name]) => name !== step));
  }
  const inner = rest.length > 0 ? done(fields[step], op, rest, value, what) : value;
  // Built from entries, since an assignment to `__proto__` would set the prototype.
  return Object.fromEntries([...Object.entries(fields).filter(([name]) => name !== step), [step, inner]]);
}

function doneInList(
  items: unknown[],
  op: Operation["op"],
  step: string,
  rest: readonly string[],
  value: unknown,
  what: string,
): unknown[] {
  if (step === "-" && op === "add" && rest.length === 0) return [...items, value];
  if (!/^(0|[1-9][0-9]{0,8})$/.test(step)) throw new Error(`${what}: '${step}' is no place in a list`);
  const place = Number(step);
  if (place > items.length || (place === items.length && (rest.length > 0 || op !== "add"))) {
    throw new Error(`${what}: the list has ${items.length} items, so there is none at ${place}`);
  }
  if (rest.length > 0) items[place] = done(items[place], op, rest, value, what);
  else if (op === "add") items.splice(place, 0, value);
  else if (op === "remove") items.splice(place, 1);
  else items[place] = value;
  return items;
}
