/** Loads and calls the WebAssembly module of apps/play: a live scene in the page itself. */

/** Data that a self-contained page carries. */
export interface Game {
  engine: Uint8Array; // the module
  scene: Uint8Array; // its image
  warnings: string[];
  start: Uint8Array | null; // the image of the state that it begins at; null: its own start
}

interface Exports {
  memory: WebAssembly.Memory;
  _initialize(): void;
  resilin_input(size: number): number;
  resilin_output(): number;
  resilin_output_size(): number;
  resilin_warn(): void;
  resilin_start(): number;
  resilin_open(): number;
  resilin_receive(isText: number): number;
  resilin_wait(): number;
  resilin_turn(): number;
  resilin_next(): number;
  resilin_run(): number;
}

const DONE = 0;
const NO_SUCH_FILE = 8; // errno BADF of WASI
const NOT_THERE = 52; // errno NOSYS of WASI

/** The system below the module: clocks and random bytes; no files, no variables, no arguments. */
function system(memory: () => WebAssembly.Memory): Record<string, (...values: never[]) => unknown> {
  const view = () => new DataView(memory().buffer);
  const putNothing = (count: number, size: number) => {
    view().setUint32(count, 0, true);
    view().setUint32(size, 0, true);
    return DONE;
  };
  return {
    clock_time_get: (clock: number, _precision: bigint, place: number) => {
      const milliseconds = clock === 0 ? Date.now() : performance.now();
      view().setBigUint64(place, BigInt(Math.round(1e6 * milliseconds)), true);
      return DONE;
    },
    random_get: (place: number, size: number) => {
      crypto.getRandomValues(new Uint8Array(memory().buffer, place, size));
      return DONE;
    },
    environ_sizes_get: putNothing,
    environ_get: () => DONE,
    args_sizes_get: putNothing,
    args_get: () => DONE,
    proc_exit: (code: number) => {
      throw new Error(`the solver ended with ${code}`);
    },
  };
}

export class Engine {
  private constructor(private readonly exports: Exports) {}

  static async load(bytes: BufferSource): Promise<Engine> {
    const module = await WebAssembly.compile(bytes);
    const known = system(() => instance.exports.memory as WebAssembly.Memory);
    const imports: Record<string, Record<string, WebAssembly.ImportValue>> = {};
    for (const { module: from, name } of WebAssembly.Module.imports(module))
      (imports[from] ??= {})[name] = known[name] ?? (() => (name.startsWith("fd_") ? NO_SUCH_FILE : NOT_THERE));
    const instance: WebAssembly.Instance = await WebAssembly.instantiate(module, imports);
    const exports = instance.exports as unknown as Exports;
    exports._initialize();
    return new Engine(exports);
  }

  /** Begins to play, at the scene's own start or at another state. */
  open(scene: Uint8Array, warnings: string[], start: Uint8Array | null = null): void {
    for (const warning of warnings) {
      this.put(new TextEncoder().encode(warning));
      this.exports.resilin_warn();
    }
    if (start) {
      this.put(start);
      this.check(this.exports.resilin_start());
    }
    this.put(scene);
    this.check(this.exports.resilin_open());
  }

  /** Where the nodes of a scene are at its end [m]. */
  run(scene: Uint8Array): Float64Array {
    this.put(scene);
    this.check(this.exports.resilin_run());
    return new Float64Array(this.output().slice().buffer);
  }

  /** The page says something. */
  receive(message: string | ArrayBuffer): void {
    const isText = typeof message === "string";
    this.put(isText ? new TextEncoder().encode(message) : new Uint8Array(message));
    this.check(this.exports.resilin_receive(isText ? 1 : 0));
  }

  /** Milliseconds until the next turn is due; null: not before the page says something. */
  wait(): number | null {
    const milliseconds = this.exports.resilin_wait();
    return milliseconds < 0 ? null : milliseconds;
  }

  turn(): void {
    this.check(this.exports.resilin_turn());
  }

  /** Returns the next message for the page; null: none. */
  next(): string | ArrayBuffer | null {
    const kind = this.exports.resilin_next();
    if (kind === 0) return null;
    return kind === 1 ? new TextDecoder().decode(this.output()) : (this.output().slice().buffer as ArrayBuffer);
  }

  private put(bytes: Uint8Array): void {
    const place = this.exports.resilin_input(bytes.length);
    new Uint8Array(this.exports.memory.buffer, place, bytes.length).set(bytes);
  }

  private output(): Uint8Array {
    const { memory, resilin_output, resilin_output_size } = this.exports;
    return new Uint8Array(memory.buffer, resilin_output(), resilin_output_size());
  }

  private check(succeeded: number): void {
    if (succeeded === 0) throw new Error(new TextDecoder().decode(this.output()));
  }
}
