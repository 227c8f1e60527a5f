// Mouse, pen, touch and wheel on the picture, and the keys that move the camera.

import { fly, pan, turn, zoom } from "./camera.js";

const CLICK_PIXELS = 4;
const WHEEL = 0.0012;
const LINE_PIXELS = 18;
const WHEEL_REST_MS = 180;
const DIRECTIONS = {
  KeyW: [0, 1, 0], KeyS: [0, -1, 0], KeyA: [-1, 0, 0], KeyD: [1, 0, 0], KeyE: [0, 0, 1], KeyQ: [0, 0, -1],
};
const TURNS = { ArrowLeft: [-0.03, 0], ArrowRight: [0.03, 0], ArrowUp: [0, 0.03], ArrowDown: [0, -0.03] };
const ZOOMS = { Equal: 1 / 1.12, NumpadAdd: 1 / 1.12, Minus: 1.12, NumpadSubtract: 1.12 };

/** Turns gestures on the picture into changes of `camera`; a click that moved nothing is a `pick` event. */
export class Pointer extends EventTarget {
  constructor(surface, store, link) {
    super();
    Object.assign(this, { surface, store, link });
    this.pointers = new Map();
    this.held = new Set();
    const on = (name, handler, options) => surface.addEventListener(name, (event) => handler.call(this, event), options);
    on("pointerdown", this.down);
    on("pointermove", this.move);
    on("pointerup", this.up);
    on("pointercancel", this.up);
    on("wheel", this.wheel, { passive: false });
    on("contextmenu", (event) => event.preventDefault());
    on("keydown", this.keydown);
    on("keyup", (event) => this.held.delete(event.code));
    on("blur", () => this.held.clear());
  }

  get camera() {
    return this.store.document?.camera;
  }

  get aspect() {
    return this.surface.clientWidth / Math.max(1, this.surface.clientHeight);
  }

  /** Change the camera, every number kept in its declared range. */
  apply(patch, time) {
    const document = this.store.document;
    const camera = { ...patch };
    for (const [name, value] of Object.entries(camera)) {
      if (typeof value === "number") camera[name] = this.store.schema.clamp(`camera.${name}`, document, value);
    }
    this.store.change({ camera }, "camera", time);
  }

  down(event) {
    if (!this.camera) return;
    this.surface.focus({ preventScroll: true });
    this.surface.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    this.start = this.pointers.size === 1 ? { x: event.clientX, y: event.clientY } : null;
    this.link.send({ type: "moving", active: true });
  }

  move(event) {
    const time = performance.now();
    const before = this.pointers.get(event.pointerId);
    if (!before || !this.camera) return;
    const now = { x: event.clientX, y: event.clientY };
    if (this.start && Math.hypot(now.x - this.start.x, now.y - this.start.y) < CLICK_PIXELS) return;
    this.start = null;
    const height = this.surface.clientHeight;
    if (this.pointers.size === 2) this.pinch(event.pointerId, before, now, height, time);
    else if (this.pointers.size === 1) {
      const [dx, dy] = [(now.x - before.x) / height, (now.y - before.y) / height];
      const panning = event.buttons & 6 || event.shiftKey;
      this.apply(panning ? pan(this.camera, dx, dy, this.aspect) : turn(this.camera, dx, dy), time);
    }
    this.pointers.set(event.pointerId, now);
  }

  /** Two fingers: their distance zooms, their middle pans. */
  pinch(id, before, now, height, time) {
    const other = [...this.pointers].find(([key]) => key !== id)[1];
    const spread = (point) => Math.max(1, Math.hypot(point.x - other.x, point.y - other.y));
    const closer = { ...this.camera, ...zoom(this.camera, spread(before) / spread(now)) };
    const [dx, dy] = [(now.x - before.x) / 2 / height, (now.y - before.y) / 2 / height];
    const moved = { ...closer, ...pan(closer, dx, dy, this.aspect) };
    const { kind, ...patch } = moved;
    this.apply(patch, time);
  }

  up(event) {
    if (!this.pointers.delete(event.pointerId)) return;
    if (this.pointers.size === 0) this.link.send({ type: "moving", active: false });
    if (this.start && event.type === "pointerup") this.pick(event.clientX, event.clientY);
    this.start = null;
  }

  pick(x, y) {
    const box = this.surface.getBoundingClientRect();
    const detail = { x: (x - box.left) / box.width, y: (y - box.top) / box.height, left: x, top: y };
    this.dispatchEvent(new CustomEvent("pick", { detail }));
  }

  wheel(event) {
    const time = performance.now();
    event.preventDefault();
    if (!this.camera) return;
    const pixels = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? event.deltaY * LINE_PIXELS : event.deltaY;
    this.apply(zoom(this.camera, Math.exp(pixels * WHEEL)), time);
    if (!this.wheeling) this.link.send({ type: "moving", active: true });
    clearTimeout(this.wheeling);
    this.wheeling = setTimeout(() => {
      this.wheeling = null;
      if (!this.pointers.size) this.link.send({ type: "moving", active: false });
    }, WHEEL_REST_MS);
  }

  keydown(event) {
    if (!this.camera || event.ctrlKey || event.metaKey || event.altKey) return;
    const time = performance.now();
    if (TURNS[event.code]) {
      const [dx, dy] = TURNS[event.code];
      this.apply(event.shiftKey ? pan(this.camera, -dx, dy, this.aspect) : turn(this.camera, dx, dy), time);
    } else if (ZOOMS[event.code]) this.apply(zoom(this.camera, ZOOMS[event.code]), time);
    else if (event.code === "Enter") this.pickMiddle();
    else if (DIRECTIONS[event.code]) this.hold(event.code);
    else return;
    event.preventDefault();
  }

  pickMiddle() {
    const box = this.surface.getBoundingClientRect();
    this.pick(box.left + box.width / 2, box.top + box.height / 2);
  }

  /** Fly while a key is held, at a speed that does not depend on the frame rate. */
  hold(code) {
    const flying = this.held.size > 0;
    this.held.add(code);
    if (flying) return;
    let last = performance.now();
    this.link.send({ type: "moving", active: true });
    const tick = (now) => {
      if (!this.held.size) {
        this.link.send({ type: "moving", active: false });
        return;
      }
      const sum = [0, 0, 0];
      for (const key of this.held) DIRECTIONS[key].forEach((value, i) => { sum[i] += value; });
      this.apply(fly(this.camera, ...sum, Math.max(0, (now - last) / 1000), this.aspect), performance.now());
      last = now;
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }
}
