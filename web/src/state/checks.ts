// Checks of JSON values that came from elsewhere: each throws an error that names the field, the value and what it must be.

export type Check = (value: unknown, where: string) => void;

export function refuse(value: unknown, where: string, must: string): never {
  throw new Error(`${where} is ${(JSON.stringify(value) ?? "missing").slice(0, 60)}; it must be ${must}`);
}

/** The largest number of a scene, as in `_storage/json_texts.py`. */
const LARGEST = 1e30;

export const number =
  (low = -LARGEST, high = LARGEST): Check =>
  (value, where) => {
    if (typeof value !== "number" || !Number.isFinite(value) || value < low || value > high) {
      refuse(value, where, low === -LARGEST ? "a number" : `a number from ${low} to ${high}`);
    }
  };
const kind =
  (name: "boolean" | "string"): Check =>
  (value, where) => {
    if (typeof value !== name) refuse(value, where, name === "string" ? "a text" : "true or false");
  };
export const oneOf =
  (...known: readonly unknown[]): Check =>
  (value, where) => {
    if (!known.includes(value)) refuse(value, where, `one of ${known.join(", ")}`);
  };
export const either =
  (wanted: unknown, check: Check): Check =>
  (value, where) => {
    if (value !== wanted) check(value, where);
  };
export const list =
  (check: Check, low = 0, high = Infinity): Check =>
  (value, where) => {
    if (!Array.isArray(value) || value.length < low || value.length > high) {
      refuse(value, where, `a list${low === high ? ` of ${low}` : low > 0 ? ` of at least ${low}` : ""}`);
    }
    (value as unknown[]).forEach((one, n) => check(one, `${where}[${n}]`));
  };
/** Check of an object; fields whose names end in "?" may be left out, "*" stands for all others. `what`: name of the whole. */
export const fields =
  (known: Readonly<Record<string, Check>>, what = "state"): Check =>
  (value, where) => {
    if (typeof value !== "object" || value === null || Array.isArray(value)) refuse(value, where || what, "an object");
    const found = value as Record<string, unknown>;
    const inside = (name: string): string => (where === "" ? name : `${where}.${name}`);
    for (const [name, check] of Object.entries(known)) {
      const plain = name.replace("?", "");
      if (name === "*") continue;
      if (Object.hasOwn(found, plain)) check(found[plain], inside(plain));
      else if (plain === name) throw new Error(`field '${inside(name)}' is missing`);
    }
    for (const name of Object.keys(found)) {
      if (name in known || `${name}?` in known) continue;
      const other = known["*"];
      if (other === undefined) throw new Error(`${where || what}: unknown field '${name}'`);
      other(found[name], inside(name));
    }
  };

export const share = number(0, 1);
export const any: Check = () => undefined;
export const text = kind("string");
export const flag = kind("boolean");
export const point = list(number(), 3, 3);
export const whole: Check = (value, where) => {
  if (!Number.isInteger(value)) refuse(value, where, "a whole number");
};

// Checks of documents: `document.generated.ts` is made of them.

/** Whole numbers, as far as floats tell them apart. */
export const integer =
  (low = -Infinity): Check =>
  (value, where) => {
    if (!Number.isSafeInteger(value) || (value as number) < low) refuse(value, where, "a whole number");
  };
/** One of several; the last says what is wrong. */
export const anyOf =
  (...checks: readonly Check[]): Check =>
  (value, where) => {
    const taken = checks.slice(0, -1).some((check) => {
      try {
        check(value, where);
        return true;
      } catch {
        return false;
      }
    });
    if (!taken) checks.at(-1)?.(value, where);
  };
/** An object is checked by one check if it has a field, else by another. */
export const by =
  (field: string, having: Check, lacking: Check): Check =>
  (value, where) =>
    (typeof value === "object" && value !== null && Object.hasOwn(value, field) ? having : lacking)(value, where);
export const tuple =
  (...checks: readonly Check[]): Check =>
  (value, where) => {
    list(any, checks.length, checks.length)(value, where);
    checks.forEach((check, n) => check((value as unknown[])[n], `${where}[${n}]`));
  };
export const direction: Check = (value, where) => {
  point(value, where);
  if (!(value as number[]).some((one) => one !== 0)) refuse(value, where, "a direction");
};
/** An object of one field, which names its kind. */
export const oneField =
  (kinds: Readonly<Record<string, Check>>): Check =>
  (value, where) => {
    fields(Object.fromEntries(Object.entries(kinds).map(([name, check]) => [`${name}?`, check])))(value, where);
    if (Object.keys(value as object).length !== 1) refuse(value, where, `an object of one field: ${Object.keys(kinds).join(", ")}`);
  };
export const byName = (names: readonly string[], check: Check): Check => fields(Object.fromEntries(names.map((name) => [`${name}?`, check])));
/** An object whose fields are whole numbers. */
export const byNumber =
  (check: Check): Check =>
  (value, where) => {
    fields({ "*": check })(value, where);
    for (const name of Object.keys(value as object)) if (!/^-?[0-9]+$/.test(name)) refuse(name, where, "an object by whole numbers");
  };
/** An object, exactly one of whose fields of some names has a value. */
export const oneGiven =
  (names: readonly string[], check: Check): Check =>
  (value, where) => {
    check(value, where);
    const given = names.filter((name) => ((value as Record<string, unknown>)[name] ?? null) !== null);
    if (given.length !== 1) throw new Error(`${where}: give one of the fields ${names.join(" and ")}`);
  };
/** A measure, with as many points as its kind has. */
export const measure =
  (check: Check): Check =>
  (value, where) => {
    check(value, where);
    const { kind: what, points } = value as { kind: string; points: unknown[] };
    list(any, what === "distance" ? 2 : 3, { distance: 2, angle: 3 }[what])(points, `${where}.points`);
  };
