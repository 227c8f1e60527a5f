// Time that runs: a button for scenes in which something moves by itself, whichever field of theirs says so.

import { iconButton } from "./dom.js";

const LONGEST_STEP = 0.1;

/** Runs the field of the document that declares how fast it plays. Nothing runs on a hidden page: no frames are asked for. */
export class Runner extends EventTarget {
  constructor(row, store, link) {
    super();
    Object.assign(this, { store, running: false });
    this.button = iconButton("wind", "Let time run", () => (this.running ? this.stop() : this.start()), { "aria-pressed": "false" });
    row.append(this.button);
    store.addEventListener("scene", () => this.look());
    link.addEventListener("lost", () => this.stop());
    this.look();
  }

  /** What plays in this scene, if anything does. */
  look() {
    this.stop();
    const { schema } = this.store;
    this.field = schema && [...schema.fields(schema.root)].find(([, node]) => node.umbrage?.plays);
    this.button.hidden = !this.field;
  }

  start() {
    this.show(true);
    const [name, { maximum = Infinity, umbrage }] = this.field;
    let before = performance.now();
    const tick = (now) => {
      if (!this.running) return;
      const seconds = Math.min(Math.max(0, now - before) / 1000, LONGEST_STEP);
      before = now;
      const value = this.store.document[name] + umbrage.plays * seconds;
      this.store.change({ [name]: value > maximum ? 0 : Number(value.toFixed(2)) }, name);
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  stop() {
    if (this.running) this.show(false);
  }

  show(running) {
    this.running = running;
    this.button.setAttribute("aria-pressed", String(running));
    this.button.setAttribute("aria-label", running ? "Hold time" : "Let time run");
    this.button.title = this.button.getAttribute("aria-label");
    this.dispatchEvent(new Event("running"));
  }
}
