// Click a point of the picture: what lies there, in numbers, with its horizon where the scene knows it.

import { el, iconButton, svg } from "./dom.js";
import { humanise } from "./form.js";
import { written } from "./controls.js";
import { radians } from "./vector.js";

const UNITS = { position: "m", elevation: "m", height: "m", distance: "m", radiance: "W m⁻² sr⁻¹", slope: "°", aspect: "°", hours: "h", sun_hours: "h" };
const SIZE = 120;
const RING = 52;

const text = (value) => (Array.isArray(value) ? value.map((item) => written(item, 0.01)).join(", ") : typeof value === "number" ? written(value, 0.01) : String(value));

/** A card beside the point clicked. */
export class Probe {
  constructor(root, pointer, link) {
    Object.assign(this, { root, link });
    this.id = 0;
    this.body = el("dl", { class: "costs" });
    this.diagram = el("div", {});
    this.mark = el("span", { class: "probe-mark", hidden: true, "aria-hidden": "true" });
    root.append(el("div", { class: "panel-head" }, el("h2", { text: "At this point" }), iconButton("close", "Close", () => this.close())), this.diagram, this.body);
    root.after(this.mark);
    pointer.addEventListener("pick", (event) => this.ask(event.detail));
    link.addEventListener("message", (event) => event.detail.type === "probe" && event.detail.id === this.id && this.show(event.detail));
  }

  ask({ x, y, left, top }) {
    this.id += 1;
    this.place = { left, top };
    this.link.send({ type: "probe", id: this.id, x: Math.min(1, Math.max(0, x)), y: Math.min(1, Math.max(0, y)) });
  }

  close() {
    this.root.hidden = this.mark.hidden = true;
  }

  show({ type, id, horizon, azimuths, ...facts }) {
    const rows = Object.entries(facts).filter(([, value]) => value !== null && typeof value !== "object" || Array.isArray(value) && value.length <= 4);
    this.body.replaceChildren(...rows.flatMap(([key, value]) => [el("dt", { text: humanise(key) }), el("dd", { text: `${text(value)} ${UNITS[key] ?? ""}`.trim() })]));
    this.diagram.replaceChildren(...(Array.isArray(horizon) ? [this.draw(horizon, azimuths)] : []));
    this.root.hidden = this.mark.hidden = false;
    this.mark.style.left = `${this.place.left}px`;
    this.mark.style.top = `${this.place.top}px`;
    const box = this.root.getBoundingClientRect();
    const left = this.place.left + 16 + box.width > innerWidth ? this.place.left - 16 - box.width : this.place.left + 16;
    this.root.style.left = `${Math.max(8, left)}px`;
    this.root.style.top = `${Math.max(64, Math.min(innerHeight - box.height - 8, this.place.top - 24))}px`;
  }

  /** The horizon round the point, zenith in the middle; elevations and azimuths in degrees, evenly spaced where none are given. */
  draw(horizon, azimuths) {
    const points = horizon.map((elevation, i) => {
      const azimuth = radians(azimuths?.[i] ?? (360 * i) / horizon.length);
      const r = (RING * (90 - Math.max(0, elevation))) / 90;
      return `${(r * Math.sin(azimuth)).toFixed(2)} ${(-r * Math.cos(azimuth)).toFixed(2)}`;
    });
    return svg("svg", { class: "horizon", viewBox: `${-SIZE / 2} ${-SIZE / 2} ${SIZE} ${SIZE}`, role: "img", "aria-label": "Horizon round this point, north up" },
      svg("circle", { class: "horizon-ground", r: RING }), svg("path", { class: "horizon-sky", d: `M${points.join("L")}Z` }));
  }
}
