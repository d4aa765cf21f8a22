/**
 * Readers of JSON: each returns what it read with its type, or throws a line that says where what was expected.
 * Types of messages are those of their readers, so that neither can say what the other does not.
 */

export type Reader<T> = (value: unknown, place: string) => T;

/** Result type of a reader. */
export type Read<R> = R extends Reader<infer T> ? T : never;

function refuse(place: string, expected: string, value: unknown): never {
  const got = value === undefined ? "nothing" : JSON.stringify(value).slice(0, 40);
  throw new Error(`${place}: expected ${expected}, got ${got}`);
}

export const text: Reader<string> = (value, place) =>
  typeof value === "string" ? value : refuse(place, "a text", value);

export const flag: Reader<boolean> = (value, place) =>
  typeof value === "boolean" ? value : refuse(place, "true or false", value);

export const number: Reader<number> = (value, place) =>
  typeof value === "number" ? value : refuse(place, "a number", value);

/** JSON has no infinity and no "not a number": the program writes null. */
export const measurement: Reader<number> = (value, place) => (value === null ? NaN : number(value, place));

export type Vector = [number, number, number];

export const vector: Reader<Vector> = (value, place) => {
  if (!Array.isArray(value) || value.length !== 3) return refuse(place, "three numbers", value);
  return [number(value[0], place), number(value[1], place), number(value[2], place)];
};

export const word =
  <const W extends string | number>(...words: W[]): Reader<W> =>
  (value, place) =>
    words.find((known) => known === value) ?? refuse(place, `one of ${words.join(", ")}`, value);

export const list =
  <T>(item: Reader<T>): Reader<T[]> =>
  (value, place) =>
    Array.isArray(value) ? value.map((entry, i) => item(entry, `${place}[${i}]`)) : refuse(place, "a list", value);

export const nullable =
  <T>(reader: Reader<T>): Reader<T | null> =>
  (value, place) =>
    value === null ? null : reader(value, place);

/** A value that may be left out. */
export const optional =
  <T>(reader: Reader<T>): Reader<T | undefined> =>
  (value, place) =>
    value === undefined ? undefined : reader(value, place);

/** The first reader that takes the value. */
export const either =
  <R extends Reader<unknown>[]>(...readers: R): Reader<Read<R[number]>> =>
  (value, place) => {
    for (const [i, reader] of readers.entries()) {
      try {
        return reader(value, place) as Read<R[number]>;
      } catch (error) {
        if (i === readers.length - 1) throw error;
      }
    }
    return refuse(place, "a value", value);
  };

function entriesOf(value: unknown, place: string): Map<string, unknown> {
  if (typeof value !== "object" || value === null || Array.isArray(value)) return refuse(place, "an object", value);
  return new Map(Object.entries(value));
}

/** An object with any keys. */
export const record =
  <T>(item: Reader<T>): Reader<Record<string, T>> =>
  (value, place) =>
    Object.fromEntries([...entriesOf(value, place)].map(([key, entry]) => [key, item(entry, `${place}.${key}`)]));

type Shape = Record<string, Reader<unknown>>;
type OptionalKeys<S> = { [K in keyof S]: undefined extends Read<S[K]> ? K : never }[keyof S];
type Shaped<S> = { [K in Exclude<keyof S, OptionalKeys<S>>]: Read<S[K]> } & {
  [K in OptionalKeys<S>]?: Read<S[K]>;
};

/** An object with these keys; others are passed over. */
export const object =
  <S extends Shape>(shape: S): Reader<Shaped<S>> =>
  (value, place) => {
    const entries = entriesOf(value, place);
    const read = Object.entries(shape).map(([key, reader]) => [key, reader(entries.get(key), `${place}.${key}`)]);
    return Object.fromEntries(read) as Shaped<S>;
  };

/** One of several kinds of object; the text at `tag` says which. */
export const tagged =
  <Tag extends string, Kinds extends Record<string, Reader<object>>>(
    tag: Tag,
    kinds: Kinds,
  ): Reader<{ [K in keyof Kinds]: { [T in Tag]: K } & Read<Kinds[K]> }[keyof Kinds]> =>
  (value, place) => {
    const kind = word(...Object.keys(kinds))(entriesOf(value, place).get(tag), `${place}.${tag}`);
    const read = { [tag]: kind, ...kinds[kind](value, place) };
    return read as unknown as { [K in keyof Kinds]: { [T in Tag]: K } & Read<Kinds[K]> }[keyof Kinds];
  };
