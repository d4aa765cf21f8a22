/** How a live page reaches its scene: over a WebSocket, or in a worker of its own. */

import type { Game } from "./engine";
import type { SendFile } from "./opener";
import type { Fault } from "./play_worker";

/** Subset of a WebSocket that a live page needs. */
export interface Transport {
  onmessage: ((event: MessageEvent<string | ArrayBuffer>) => void) | null;
  onclose: (() => void) | null;
  readonly readyState: number;
  send(message: string | ArrayBuffer): void;
  close(): void;
}

/** Where a scene is. */
export interface Scenery {
  open(): Transport;
  /** Null when the scene can be opened again, else why not yet. */
  isAway(): Promise<string | null>;
  lost: string; // message when the connection ends
  send: SendFile; // takes a file and shows it in place of the scene
}

const LOST =
  "The connection is lost. If the network failed, this page reconnects by itself. If the program " +
  "has ended, start it again and open the address that it prints: each start has a new one.";
const NEW_TOKEN =
  "The program was started again and has a new address. Open the one that it has printed; this one is no longer valid.";

/** A scene that `resilin view` serves. */
export function served(token: string): Scenery {
  return {
    open() {
      const address = new URL("live", location.href);
      address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
      address.search = new URLSearchParams({ token }).toString();
      address.hash = "";
      const socket = new WebSocket(address);
      socket.binaryType = "arraybuffer";
      return socket as Transport;
    },
    async isAway() {
      // Plain HTTP says whether the program is there before a socket is opened anew.
      try {
        const answer = await fetch(`?${new URLSearchParams({ token })}`, { cache: "no-store" });
        return answer.ok ? null : NEW_TOKEN;
      } catch {
        return LOST;
      }
    },
    lost: LOST,
    async send(file) {
      const address = `open?token=${encodeURIComponent(token)}&name=${encodeURIComponent(file.name)}`;
      const answer = await fetch(address, { method: "POST", body: file }).catch(() => {
        throw new Error(`“${file.name}” cannot be sent: the file cannot be read, or the program has ended.`);
      });
      const words = (await answer.text()).trim();
      if (!answer.ok) throw new Error(words || `The program refuses the file (${answer.status}).`);
    },
  };
}

/** Messages of the host of a page in a notebook, beside those of docs/view_protocol.md. */
interface Ending {
  end: string; // the words of who ends
}

/** A scene of the program whose notebook shows the page. What is around the page carries the words over a port. */
export class HostedTransport implements Transport {
  onmessage: ((event: MessageEvent<string | ArrayBuffer>) => void) | null = null;
  onclose: (() => void) | null = null;
  readyState: number = WebSocket.CONNECTING;
  private port: MessagePort | null = null;

  constructor(private readonly ended: (words: string) => void) {
    addEventListener("message", this.connect);
    parent.postMessage("resilin: open", "*");
  }

  private readonly connect = (event: MessageEvent<unknown>): void => {
    if (event.source !== parent || event.data !== "resilin: port" || event.ports.length !== 1) return;
    removeEventListener("message", this.connect);
    [this.port] = event.ports;
    this.readyState = WebSocket.OPEN;
    this.port.onmessage = (message: MessageEvent<string | ArrayBuffer | Ending>) => {
      if (typeof message.data === "string" || message.data instanceof ArrayBuffer)
        return this.onmessage?.(message as MessageEvent<string | ArrayBuffer>);
      this.ended(message.data.end);
      this.close();
    };
  };

  send(message: string | ArrayBuffer): void {
    this.port?.postMessage(message);
  }

  close(): void {
    if (this.readyState === WebSocket.CLOSED) return;
    this.readyState = WebSocket.CLOSED;
    this.port?.close();
    this.onclose?.();
  }
}

/** A scene of a notebook's program: when it has ended it does not come back to this page. */
export function hosted(): Scenery {
  let ended: string | null = null;
  const scenery: Scenery = {
    open: () => new HostedTransport((words) => (scenery.lost = ended = words)),
    isAway: async () => ended,
    lost: "The connection is lost.",
    send: null,
  };
  return scenery;
}

/** A scene that the page has with it. A worker simulates: the page stays free to draw. */
export class WorkerTransport implements Transport {
  onmessage: ((event: MessageEvent<string | ArrayBuffer>) => void) | null = null;
  onclose: (() => void) | null = null;
  readyState: number = WebSocket.OPEN;
  hasSpoken = false;
  private readonly worker: Worker;

  constructor(
    program: string,
    game: Game,
    private readonly faulty: (words: string) => void,
  ) {
    const address = URL.createObjectURL(new Blob([program], { type: "text/javascript" }));
    this.worker = new Worker(address);
    URL.revokeObjectURL(address);
    this.worker.onmessage = (event: MessageEvent<string | ArrayBuffer | Fault>) => {
      if (typeof event.data !== "string" && !(event.data instanceof ArrayBuffer)) return this.fail(event.data.fault);
      this.hasSpoken = true;
      this.onmessage?.(event as MessageEvent<string | ArrayBuffer>);
    };
    this.worker.onerror = (event) => this.fail(event.message);
    this.worker.postMessage(game);
  }

  send(message: string | ArrayBuffer): void {
    this.worker.postMessage(message);
  }

  close(): void {
    if (this.readyState === WebSocket.CLOSED) return;
    this.readyState = WebSocket.CLOSED;
    this.worker.terminate();
    this.onclose?.();
  }

  private fail(words: string): void {
    this.faulty(words);
    this.close();
  }
}

/** A scene that the page has with it: after a fault it begins anew, unless it has failed before anything was shown. */
export function carried(program: string, game: Game): Scenery {
  let hopeless: string | null = null;
  const scenery: Scenery = {
    open() {
      const transport = new WorkerTransport(program, game, (words) => {
        if (!transport.hasSpoken) hopeless = `The scene cannot be simulated. ${words}`;
        scenery.lost = hopeless ?? `The scene restarts. ${words}`;
      });
      return transport;
    },
    isAway: async () => hopeless,
    lost: "The scene restarts.",
    send: null,
  };
  return scenery;
}
