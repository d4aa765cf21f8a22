/** The connection to a live scene. Frames wait here until one is drawn; what comes meanwhile replaces them. */

import {
  decodeFrame,
  decodeMessage,
  decodeTopology,
  encodeMessage,
  isFrame,
  vertexCount,
  type Frame,
  type Hello,
  type PageMessage,
  type Point,
  type State,
  type Status,
  type Topology,
} from "./protocol";
import type { Scenery, Transport } from "./transport";

export interface LiveEvents {
  scene(hello: Hello, topology: Topology): void;
  state(state: State): void;
  status(status: Status): void;
  refused(message: string): void;
  told(message: string): void;
  lost(words: string): void;
  found(): void;
}

const NOT_UNDERSTOOD = "This page does not match the program; reload the page.";
const RETRY = 1000; // [ms]

export class LiveConnection {
  connected = false;
  answeredDrag = 0;
  private transport: Transport | null = null;
  private hello: Hello | null = null;
  private waitingForTopology = false;
  private newest: ArrayBuffer | null = null;
  private positions = new Float32Array(0);
  private dragNumber = 0;
  private readonly sentAt = new Map<number, number>(); // [ms] of drags without an answer
  dragLatencies: number[] = []; // [ms] from a drag message to the drawn frame that answers it

  constructor(
    private readonly scenery: Scenery,
    private readonly events: LiveEvents,
  ) {}

  connect(): void {
    const transport = this.scenery.open();
    transport.onmessage = ({ data }) => this.receive(data);
    transport.onclose = () => this.retry();
    this.transport = transport;
  }

  private async retry(): Promise<void> {
    this.connected = false;
    this.newest = null;
    this.events.lost(this.scenery.lost);
    for (;;) {
      await new Promise((done) => setTimeout(done, RETRY));
      const words = await this.scenery.isAway();
      if (words === null) break;
      this.events.lost(words);
    }
    this.connect();
  }

  private receive(data: string | ArrayBuffer): void {
    try {
      if (typeof data === "string") this.receiveText(data);
      else this.receiveBinary(data);
    } catch (error) {
      this.events.refused(`${NOT_UNDERSTOOD} ${error instanceof Error ? error.message : String(error)}`);
    }
  }

  private receiveText(text: string): void {
    const message = decodeMessage(text);
    switch (message.type) {
      case "hello":
        this.hello = message;
        this.waitingForTopology = true;
        this.newest = null;
        break;
      case "state":
        this.events.state(message);
        break;
      case "status":
        this.events.status(message);
        break;
      case "error":
        this.events.refused(message.message);
        break;
      case "note":
        this.events.told(message.message);
        break;
      default:
        message satisfies never;
    }
  }

  private receiveBinary(buffer: ArrayBuffer): void {
    if (this.waitingForTopology && this.hello) {
      this.waitingForTopology = false;
      const topology = decodeTopology(buffer, this.hello);
      this.positions = new Float32Array(3 * vertexCount(this.hello.parts));
      this.connected = true;
      this.sentAt.clear();
      this.events.found();
      this.events.scene(this.hello, topology);
      this.events.state(this.hello.state);
    } else if (isFrame(buffer)) {
      this.newest = buffer;
    }
  }

  /** The newest frame that has not been drawn; null: there is none. */
  takeFrame(): Frame | null {
    if (!this.newest) return null;
    const frame = decodeFrame(this.newest, this.positions);
    this.newest = null;
    return frame;
  }

  /** To be called when `frame` has been drawn: the program sends the next one. */
  acknowledge(frame: Frame): void {
    this.answeredDrag = frame.answersDrag;
    for (const [number, sent] of this.sentAt) {
      if (number > frame.answersDrag) continue;
      this.dragLatencies.push(performance.now() - sent);
      this.sentAt.delete(number);
    }
    this.dragLatencies = this.dragLatencies.slice(-500);
    this.send({ type: "acknowledge", frame: frame.number });
  }

  send(message: PageMessage): void {
    if (this.isOpen()) this.transport!.send(encodeMessage(message));
  }

  drag(target: Point): void {
    if (!this.isOpen()) return;
    this.sentAt.set(++this.dragNumber, performance.now());
    this.send({ type: "drag", number: this.dragNumber, target });
  }

  /** Closes the connection as a failing network would. */
  drop(): void {
    this.transport?.close();
  }

  private isOpen(): boolean {
    return this.transport?.readyState === WebSocket.OPEN;
  }
}
