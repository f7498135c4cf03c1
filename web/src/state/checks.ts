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
