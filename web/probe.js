// Click a point of the picture: what lies there, in numbers, with its horizon and the sun's course where they are known.
// Fetched with the first click.

import { el, humanise, iconButton, svg, terms } from "./dom.js";
import { onSky, pathOnSky, winds } from "./sun.js";

const UNITS = { position: "m", elevation: "m", height: "m", distance: "m", slope: "°", aspect: "°", hours: "h", sun_hours: "h" };
const NAMES = { position: "East, north, up", elevation: "Above the sea", sun_up: "Sees the sun", sun_hours: "Sun on this day",
  eye_height: "Horizon seen from", radiance: "W m⁻² sr⁻¹ in RGB" };
const SIZE = 136;
const RING = 52;
const FIGURES = 3;
const AGAIN_MS = 300;

/** Three figures after a zero, none after hundreds. */
function figures(value) {
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value !== "number") return String(value);
  return Math.abs(value) >= 10 ** FIGURES ? value.toFixed(0) : String(Number(value.toPrecision(FIGURES)));
}

function text(key, value) {
  if (key === "eye_height") return value > 0 ? `treetops, ${figures(value)} m` : "the ground";
  const words = Array.isArray(value) ? value.map(figures).join(", ") : figures(value);
  return typeof value === "boolean" ? words : `${words} ${UNITS[key] ?? ""}`.trim();
}

/** A card beside the point clicked. */
export class Probe {
  constructor(root, link, store, sun) {
    Object.assign(this, { root, link, store, sun });
    this.id = 0;
    this.body = el("dl", { class: "costs" });
    this.diagram = el("div", {});
    this.mark = el("span", { class: "probe-mark", hidden: true, "aria-hidden": "true" });
    root.append(el("div", { class: "panel-head" }, el("h2", { text: "At this point" }), iconButton("close", "Close", () => this.close())), this.diagram, this.body);
    root.after(this.mark);
    addEventListener("keydown", (event) => event.key === "Escape" && this.close());
    store.addEventListener("change", () => this.root.hidden || this.follow());
    link.addEventListener("message", (event) => event.detail.type === "probe" && event.detail.id === this.id && this.show(event.detail));
  }

  ask({ x, y, left, top }) {
    this.id += 1;
    this.place = { x, y, left, top };
    this.asked = this.store.document;
    this.link.send({ type: "probe", id: this.id, x: Math.min(1, Math.max(0, x)), y: Math.min(1, Math.max(0, y)) });
  }

  /** Another camera shows another point there; another sun asks for the same point again. */
  follow() {
    if (this.store.document.camera !== this.asked.camera) this.close();
    else {
      clearTimeout(this.timer);
      this.timer = setTimeout(() => this.ask(this.place), AGAIN_MS);
    }
  }

  close() {
    clearTimeout(this.timer);
    this.root.hidden = this.mark.hidden = true;
  }

  show({ type, id, horizon, azimuths, ...facts }) {
    const rows = Object.entries(facts).filter(([, value]) => value !== null);
    this.body.replaceChildren(...terms(rows.map(([key, value]) => [NAMES[key] ?? humanise(key), text(key, value)])));
    this.diagram.replaceChildren(...(Array.isArray(horizon) ? [this.draw(horizon, azimuths)] : []));
    this.root.hidden = this.mark.hidden = false;
    this.mark.style.left = `${this.place.left}px`;
    this.mark.style.top = `${this.place.top}px`;
    const box = this.root.getBoundingClientRect();
    const left = this.place.left + 16 + box.width > innerWidth ? this.place.left - 16 - box.width : this.place.left + 16;
    const bar = document.querySelector("#sun").getBoundingClientRect();
    const under = left < bar.right && left + box.width > bar.left;
    const floor = under && bar.top - box.height > 64 ? bar.top : innerHeight;
    this.root.style.left = `${Math.max(8, left)}px`;
    this.root.style.top = `${Math.max(64, Math.min(floor - box.height - 8, this.place.top - 24))}px`;
  }

  /** The horizon round the point, zenith in the middle, with the sun and its course; degrees, evenly spaced without azimuths. */
  draw(horizon, azimuths) {
    const rim = horizon.map((elevation, i) => ({ elevation: Math.max(0, elevation), azimuth: azimuths?.[i] ?? (360 * i) / horizon.length }));
    const { placed, day } = this.sun();
    const course = pathOnSky(day?.up ?? [], RING);
    const [cx, cy] = placed ? onSky(placed, RING) : [];
    return svg("svg", { class: "horizon", viewBox: `${-SIZE / 2} ${-SIZE / 2} ${SIZE} ${SIZE}`, role: "img", "aria-label": "Horizon round this point and the sun's course, north up" },
      svg("circle", { class: "horizon-ground", r: RING }), svg("path", { class: "horizon-sky", d: `${pathOnSky(rim, RING)}Z` }), winds(RING),
      course ? svg("path", { class: "horizon-course", d: course }) : [],
      placed?.elevation >= 0 ? svg("circle", { class: "horizon-sun", r: 4, cx, cy }) : []);
  }
}
