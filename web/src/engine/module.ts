// The renderer as a module of WebAssembly (`crates/wasm`): one volume, its look and camera, drawn on the caller's thread.
// It runs in Node and in a worker of a page. A module that has failed, or a second volume, needs a new instance.

import type { Vec3 } from "../state/state.ts";

/** The functions of the module; see `crates/wasm/src/lib.rs`. */
interface Functions {
  readonly memory: WebAssembly.Memory;
  readonly ws_alloc: (n: number) => number;
  readonly ws_free: (at: number, n: number) => void;
  readonly ws_open: (name: number, nameLength: number, file: number, fileLength: number) => number;
  readonly ws_open_samples: (head: number, headLength: number, bytes: number, bytesLength: number) => number;
  readonly ws_ask: (question: number, questionLength: number, asked: number, askedLength: number) => number;
  readonly ws_answer: () => number;
  readonly ws_answer_len: () => number;
}

export type SampleType = "uint8" | "int8" | "uint16" | "int16" | "uint32" | "int32" | "float32" | "float64";

/** Facts that a file states about its volume; null where it does not. */
export interface ModuleFacts {
  readonly unit: string | null;
  readonly is_anatomical: boolean;
  readonly modality: string | null;
  readonly value_unit: string | null;
  readonly quantity: string | null;
}

/** Samples that the page has read by itself. */
export interface SamplesHead {
  readonly name: string;
  readonly type: SampleType;
  /** Samples along x, y and z. */
  readonly size: Vec3;
  /** Rows of 3 x 4. */
  readonly world_from_index: readonly (readonly number[])[];
  readonly facts?: Partial<ModuleFacts>;
}

/** A volume that the module has opened. */
export interface OpenedVolume extends SamplesHead {
  readonly range: readonly [number, number];
  readonly n_missing: number;
  readonly facts: ModuleFacts & { readonly conventions: readonly string[]; readonly guesses: readonly string[] };
}

export interface FoundKind {
  readonly kind: string;
  readonly reason: string;
  readonly is_guess: boolean;
}

/** A camera as documents have it, with one of the last two fields. */
export interface CameraFields {
  readonly version: 1;
  readonly position: Vec3;
  readonly focal_point: Vec3;
  readonly view_up: Vec3;
  readonly parallel_scale?: number;
  readonly view_angle?: number;
}

/** Where the camera shall stand. Angles in degrees; `aspect`: width over height; orthographic without `view_angle`. */
export type CameraWish =
  | { readonly fit: true; readonly aspect?: number }
  | { readonly view: string; readonly aspect?: number; readonly zoom?: number; readonly view_angle?: number }
  | { readonly orbit: readonly [number, number]; readonly aspect?: number; readonly zoom?: number; readonly view_angle?: number }
  | { readonly turned: Vec3 }
  | { readonly zoomed: number }
  | { readonly document: CameraFields };

/** The look that suits the volume, a preset, or a document. */
export type LookWish = { readonly auto: true } | { readonly preset: string } | { readonly document: unknown };

/** A look that the module has taken. */
export interface TakenLook {
  readonly name: string;
  readonly reason: string;
  /** Whether the corner nearest to the eye is left out. */
  readonly is_cut_open: boolean;
  /** The document of the look, which gives the same look again; null for a look that is cut open. */
  readonly document: unknown;
}

export type DocumentKind = "camera" | "look" | "transfer function" | "transfer function 2d" | "materials" | "scene" | "state" | "view";

/** A plane of pixels in the world: the centre of the first one, and the steps along a row and to the next row. */
export interface SlicePlane {
  readonly origin: Vec3;
  readonly across: Vec3;
  readonly down: Vec3;
  readonly size: readonly [number, number];
  readonly slab?: { readonly n_planes: number; readonly step: Vec3; readonly reduction: "maximum" | "minimum" | "mean" };
}

/** A refusal of the module: a wrong file, name or number. The instance goes on. */
export class ModuleError extends Error {
  override readonly name = "ModuleError";
}

/** The module has ended by a fault of its own, or for want of memory. Its instance must be thrown away. */
export class ModuleEnded extends Error {
  override readonly name = "ModuleEnded";
}

const toBytes = new TextEncoder();
const toText = new TextDecoder();

/** An instance of the module. */
export class VolumeModule {
  readonly #functions: Functions;
  #ended: ModuleEnded | null = null;

  private constructor(functions: Functions) {
    this.#functions = functions;
  }

  /** A new instance of a compiled module; compiling takes longer, and is done once. */
  static async of(compiled: WebAssembly.Module): Promise<VolumeModule> {
    const { exports } = await WebAssembly.instantiate(compiled, {});
    return new VolumeModule(exports as unknown as Functions);
  }

  /** Bytes of memory that the instance has taken; it never gives any back. */
  get memoryBytes(): number {
    return this.#functions.memory.buffer.byteLength;
  }

  /** Opens a NIfTI or NRRD file. */
  open(name: string, file: Uint8Array): OpenedVolume {
    return this.#json(this.#call("ws_open", toBytes.encode(name), file)) as OpenedVolume;
  }

  /** Opens samples: little-endian, x fastest. */
  openSamples(head: SamplesHead, bytes: Uint8Array): OpenedVolume {
    return this.#json(this.#call("ws_open_samples", this.#text(head), bytes)) as OpenedVolume;
  }

  kind(): FoundKind {
    return this.#ask("kind") as FoundKind;
  }

  presets(): readonly string[] {
    return this.#ask("presets") as string[];
  }

  /** Level of the vectors that the module is compiled for. */
  vectors(): string {
    return this.#ask("vectors") as string;
  }

  look(wish: LookWish): TakenLook {
    return this.#ask("look", wish) as TakenLook;
  }

  /** Takes the scene of a document whose layers show the volume, with its camera, if it has one. */
  scene(document: unknown): { readonly size: readonly [number, number] | null; readonly camera: CameraFields | null } {
    return this.#ask("scene", { document }) as { size: [number, number] | null; camera: CameraFields | null };
  }

  camera(wish: CameraWish): CameraFields {
    return this.#ask("camera", wish) as CameraFields;
  }

  /**
   * Draws a picture; the pixels are red, green, blue and opacity, straight, as a canvas takes them. Without a quality it is
   * the scene's, or normal.
   */
  draw(size: readonly [number, number], quality?: "draft" | "normal" | "fine" | "high"): Uint8ClampedArray<ArrayBuffer> {
    return new Uint8ClampedArray(this.#call("ws_ask", toBytes.encode("draw"), this.#text({ size, quality })).slice().buffer);
  }

  /** The last picture as floats, premultiplied. */
  floats(): Float32Array {
    return new Float32Array(this.#call("ws_ask", toBytes.encode("floats"), this.#text({})).slice().buffer);
  }

  /** Values on a plane, row by row; NaN outside the volume. */
  slice(plane: SlicePlane): Float32Array {
    return new Float32Array(this.#call("ws_ask", toBytes.encode("slice"), this.#text(plane)).slice().buffer);
  }

  /** The samples where they lie in memory of the module: to be used before its next call. */
  samples(): Uint8Array {
    return this.#call("ws_ask", toBytes.encode("samples"), this.#text({}));
  }

  /** A document, if it is valid; else the error names the field. */
  check(kind: DocumentKind, text: string): unknown {
    return this.#ask("check", { kind, text });
  }

  /** A document with the operations of a JSON patch done. */
  patch(document: unknown, operations: unknown): unknown {
    return this.#ask("patch", { document, operations });
  }

  #ask(question: string, asked: unknown = {}): unknown {
    return this.#json(this.#call("ws_ask", toBytes.encode(question), this.#text(asked)));
  }

  #text(value: unknown): Uint8Array {
    return toBytes.encode(JSON.stringify(value));
  }

  #json(answer: Uint8Array): unknown {
    return JSON.parse(toText.decode(answer));
  }

  /** The answer to a call, in memory of the module: valid until the next one. */
  #call(name: "ws_open" | "ws_open_samples" | "ws_ask", first: Uint8Array, second: Uint8Array): Uint8Array {
    if (this.#ended) throw this.#ended;
    const given = [first, second].map((bytes) => this.#put(bytes));
    const [a, b] = given as [number, number];
    let isError: number;
    try {
      isError = this.#functions[name](a, first.length, b, second.length);
    } catch (error) {
      const panic = toText.decode(this.#answer());
      this.#ended = new ModuleEnded(panic || `memory is refused: ${this.memoryBytes} bytes are taken`, { cause: error });
      throw this.#ended;
    }
    const answer = this.#answer();
    if (isError) throw new ModuleError(toText.decode(answer));
    return answer;
  }

  #answer(): Uint8Array {
    const { memory, ws_answer, ws_answer_len } = this.#functions;
    return new Uint8Array(memory.buffer, ws_answer() >>> 0, ws_answer_len());
  }

  #put(bytes: Uint8Array): number {
    const at = this.#functions.ws_alloc(bytes.length) >>> 0;
    if (at === 0) {
      this.#ended = new ModuleEnded(`memory is refused: ${bytes.length} bytes more than the ${this.memoryBytes} that are taken`);
      throw this.#ended;
    }
    new Uint8Array(this.#functions.memory.buffer, at, bytes.length).set(bytes);
    return at;
  }
}
