/** The worker of a page that carries its scene: the other end of what a live page says to a server. */

import { Engine, type Game } from "./engine";

/** Messages of the worker to the page beside those of docs/view_protocol.md. */
export interface Fault {
  fault: string;
}

const scope = self as unknown as {
  onmessage: ((event: MessageEvent<Game | string | ArrayBuffer>) => void) | null;
  postMessage(message: unknown, transfer?: Transferable[]): void;
};

let engine: Engine | null = null;
let timer: ReturnType<typeof setTimeout> | undefined;

/** Does what is due, tells the page what is new, and comes back for the next turn. */
function go(): void {
  clearTimeout(timer);
  if (engine === null) return;
  if (engine.wait() === 0) engine.turn();
  for (let message = engine.next(); message !== null; message = engine.next())
    scope.postMessage(message, typeof message === "string" ? [] : [message]);
  const wait = engine.wait();
  if (wait !== null) timer = setTimeout(() => guarded(go), wait);
}

/** A fault ends the scene: the memory of the module is not to be trusted after it. */
function guarded(work: () => void): void {
  try {
    work();
  } catch (error) {
    engine = null;
    scope.postMessage({ fault: error instanceof Error ? error.message : String(error) } satisfies Fault);
  }
}

async function open(game: Game): Promise<void> {
  try {
    const loaded = await Engine.load(game.engine as BufferSource);
    loaded.open(game.scene, game.warnings, game.start);
    engine = loaded;
  } catch (error) {
    scope.postMessage({ fault: error instanceof Error ? error.message : String(error) } satisfies Fault);
  }
  guarded(go);
}

scope.onmessage = ({ data }) => {
  if (typeof data !== "string" && !(data instanceof ArrayBuffer)) void open(data);
  else if (engine !== null)
    guarded(() => {
      engine!.receive(data);
      go();
    });
};
