// The WebSocket: handshake, sending changes at the pace of the pictures, coming back after a loss.

import { combine } from "./document.js";

const PROTOCOL = 1;
const OUTSTANDING = 2;
const RESEND_AFTER_MS = 120;
const BACKOFF_MS = [250, 500, 1000, 2000, 4000, 8000];

/**
 * One session with the server.
 *
 * Events: `open` (welcome), `lost`, `message` (any typed JSON message), `frame` (ArrayBuffer), `accepted`, `refused`.
 * At most two changes are on their way without their picture; newer ones wait, merged into one patch.
 */
export class Link extends EventTarget {
  constructor(store, hello) {
    super();
    this.store = store;
    this.hello = hello;
    this.attempt = 0;
    this.ready = false;
    this.pending = null;
    this.sent = [];
    this.nextId = 1;
    store.addEventListener("patch", (event) => this.queue("patch", event.detail.patch, event.detail.time));
    store.addEventListener("replace", (event) => this.queue("state", event.detail.document, event.detail.time));
  }

  connect() {
    const address = new URL("api/session", document.baseURI);
    address.protocol = address.protocol.replace("http", "ws");
    address.hash = address.search = "";
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onopen = () => this.send({ type: "hello", protocol: PROTOCOL, codecs: ["jpeg", "png"], ...this.hello() });
    socket.onmessage = (event) => {
      if (this.socket !== socket) return;
      if (typeof event.data === "string") this.receive(JSON.parse(event.data));
      else this.dispatchEvent(new CustomEvent("frame", { detail: event.data }));
    };
    socket.onclose = (event) => this.socket === socket && this.lose(event.reason);
  }

  lose(reason) {
    this.ready = false;
    this.sent = [];
    this.pending = null;
    const wait = BACKOFF_MS[Math.min(this.attempt, BACKOFF_MS.length - 1)];
    this.attempt += 1;
    this.dispatchEvent(new CustomEvent("lost", { detail: { reason, wait } }));
    this.timer = setTimeout(() => this.connect(), wait);
  }

  /** Try again now rather than after the pause. */
  retry() {
    if (this.ready || this.socket?.readyState === WebSocket.CONNECTING) return;
    clearTimeout(this.timer);
    this.connect();
  }

  send(message) {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  receive(message) {
    if (message.type === "welcome") {
      this.ready = true;
      this.attempt = 0;
      this.dispatchEvent(new CustomEvent("open", { detail: message }));
    } else if (message.type === "progress") this.untime();
    else if (message.type === "state") this.settle(message);
    else if (message.type === "error") this.refuse(message);
    this.dispatchEvent(new CustomEvent("message", { detail: message }));
  }

  /** A change of the document, to be sent as soon as the pictures keep up. */
  queue(type, body, time) {
    if (type === "state" || !this.pending) this.pending = { type, body, time };
    else if (this.pending.type === "state") this.pending = { type: "state", body: this.store.document, time };
    else this.pending = { type, body: combine(this.pending.body, body), time };
    this.pump();
  }

  pump() {
    if (!this.ready || !this.pending) return;
    const now = performance.now();
    const waiting = this.sent.filter((entry) => now - entry.at < RESEND_AFTER_MS);
    if (waiting.length >= OUTSTANDING) {
      clearTimeout(this.retryTimer);
      this.retryTimer = setTimeout(() => this.pump(), RESEND_AFTER_MS);
      return;
    }
    const { type, body, time } = this.pending;
    const id = this.nextId;
    this.nextId += 1;
    this.pending = null;
    this.sent.push({ id, time, at: now, version: null, body });
    this.send({ type, id, [type]: body });
  }

  /** The server accepted a change and says which version it became. */
  settle(message) {
    const entry = this.sent.find((item) => item.id === message.id);
    if (entry) entry.version = message.version;
    const waiting = this.pending !== null || this.sent.some((item) => item.version === null);
    this.store.accept(message.state, waiting);
  }

  refuse(message) {
    const entry = this.sent.find((item) => item.id === message.id);
    if (!entry) return;
    this.sent = this.sent.filter((item) => item !== entry);
    this.store.refuse(this.pending?.type === "patch" ? this.pending.body : null);
    this.pump();
  }

  /** A picture of `version` was drawn: the input times of the changes it shows, newest last. */
  drawn(version) {
    const shown = this.sent.filter((entry) => entry.version !== null && entry.version <= version);
    this.sent = this.sent.filter((entry) => !shown.includes(entry));
    this.pump();
    return shown.map((entry) => entry.time).filter((time) => time !== null);
  }

  /** A precomputation began: what waits for it says nothing about latency. */
  untime() {
    for (const entry of this.sent) entry.time = null;
  }

  ack(sequence) {
    this.send({ type: "ack", sequence });
  }
}
