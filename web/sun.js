// Where the sun is: the day's path from the server, and the dome on which the sun is dragged.

import { measureSun } from "./api.js";
import { follow, svg } from "./dom.js";
import { degrees, radians, wrap } from "./vector.js";

const LOWEST = -18;
const SIZE = 100;
const HORIZON = 40;
const MINUTES = 1440;

/** Minutes after midnight of the first `HH:MM[:SS]` in a text, or null. */
export function minutesOf(text) {
  const found = /(\d\d):(\d\d)(?::(\d\d))?/.exec(text ?? "");
  return found ? Number(found[1]) * 60 + Number(found[2]) + Number(found[3] ?? 0) / 60 : null;
}

/** `HH:MM:SS` of minutes after midnight. */
export function clock(minutes) {
  const seconds = Math.min(MINUTES * 60 - 1, Math.max(0, Math.round(minutes * 60)));
  return [seconds / 3600, (seconds / 60) % 60, seconds % 60].map((part) => String(Math.floor(part)).padStart(2, "0")).join(":");
}

/** The nearest of the eight winds, as `SW`. */
export function compass(azimuth) {
  return ["N", "NE", "E", "SE", "S", "SW", "W", "NW"][Math.round(wrap(azimuth) / 45) % 8];
}

/** The course of one day at one place, as the server computed it. */
export class Day {
  constructor(answer) {
    const note = (word) => minutesOf(answer.meta.notes.find((text) => text.startsWith(word)));
    this.sunrise = note("sunrise");
    this.sunset = note("sunset");
    this.path = answer.day_seconds.map((seconds, i) => ({
      minutes: seconds / 60, azimuth: degrees(answer.day_azimuth_rad[i]), elevation: degrees(answer.day_elevation_rad[i]),
    }));
  }

  /** The part of the course above the horizon. */
  get up() {
    return this.path.filter((point) => point.elevation >= 0);
  }

  /** Azimuth and elevation at a time of the day, between the server's points. */
  at(minutes) {
    const after = this.path.findIndex((point) => point.minutes >= minutes);
    if (after <= 0) return this.path[Math.max(0, after)] ?? null;
    const [a, b] = [this.path[after - 1], this.path[after]];
    const t = (minutes - a.minutes) / (b.minutes - a.minutes || 1);
    const turn = ((b.azimuth - a.azimuth + 540) % 360) - 180;
    return { azimuth: wrap(a.azimuth + t * turn), elevation: a.elevation + t * (b.elevation - a.elevation) };
  }

  /** The minute of the day when the sun is nearest to a direction. */
  nearest(sun) {
    let best = { distance: Infinity, minutes: MINUTES / 2 };
    for (const point of this.path) {
      const turn = (((point.azimuth - sun.azimuth + 540) % 360) - 180) * Math.cos(radians(sun.elevation));
      const distance = Math.hypot(turn, point.elevation - sun.elevation);
      if (distance < best.distance) best = { distance, minutes: point.minutes };
    }
    return best.minutes;
  }
}

/** Fetches days; the latest asked for wins, each place and date once. */
export class Days {
  constructor() {
    this.known = new Map();
  }

  async get(moment) {
    const noon = { ...moment, time: "12:00:00" };
    const key = JSON.stringify(noon);
    if (!this.known.has(key)) this.known.set(key, measureSun(noon).then((answer) => new Day(answer)));
    return this.known.get(key);
  }
}

/** The letters of the four winds round a circle. */
export function winds(radius) {
  return [["N", 0, -radius - 3.5], ["E", radius + 6, 3], ["S", 0, radius + 9], ["W", -radius - 6.5, 3]].map(([text, x, y]) =>
    svg("text", { class: "dome-letter", x, y, "text-anchor": "middle", "aria-hidden": "true", text }));
}

/** Where a direction in degrees lies on a picture of the sky: centre is the zenith, the ring of `radius` the horizon. */
export function onSky({ azimuth, elevation }, radius) {
  const r = (radius * (90 - elevation)) / 90;
  return [r * Math.sin(radians(azimuth)), -r * Math.cos(radians(azimuth))];
}

/** Path through directions, in the same picture. */
export function pathOnSky(directions, radius) {
  const points = directions.map((at) => onSky(at, radius).map((value) => value.toFixed(2)).join(" "));
  return points.length ? `M${points.join("L")}` : "";
}

/** A view of the sky from below turned north up: centre is the zenith, the ring the horizon. */
export class Dome {
  constructor(root, onDrag, onGesture) {
    this.onDrag = onDrag;
    this.path = svg("path", { class: "dome-path" });
    this.ray = svg("path", { class: "dome-ray" });
    this.handle = svg("circle", { class: "dome-sun", r: 6, tabindex: 0, role: "slider", "aria-label": "Sun",
      "aria-valuemin": LOWEST, "aria-valuemax": 90 });
    const rings = [30, 60].map((elevation) => svg("circle", { class: "dome-ring", r: ((90 - elevation) / 90) * HORIZON }));
    this.svg = svg("svg", { class: "dome", viewBox: `${-SIZE / 2} ${-SIZE / 2} ${SIZE} ${SIZE}` },
      svg("circle", { class: "dome-disc", r: HORIZON }), rings, winds(HORIZON), this.path, this.ray, this.handle);
    root.append(this.svg);
    this.svg.addEventListener("pointerdown", (event) => this.down(event, onGesture));
    this.handle.addEventListener("keydown", (event) => this.key(event));
  }

  down(event, onGesture) {
    const move = (moved) => {
      const time = performance.now();
      const box = this.svg.getBoundingClientRect();
      const x = ((moved.clientX - box.left) / box.width - 0.5) * SIZE;
      const y = ((moved.clientY - box.top) / box.height - 0.5) * SIZE;
      const elevation = Math.max(LOWEST, 90 - (Math.hypot(x, y) / HORIZON) * 90);
      this.onDrag({ azimuth: wrap(degrees(Math.atan2(x, -y))), elevation }, time);
    };
    event.preventDefault();
    this.handle.focus({ preventScroll: true });
    onGesture(true);
    move(event);
    follow(this.svg, event, move, () => onGesture(false));
  }

  key(event) {
    const step = event.shiftKey ? 10 : 1;
    const moves = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] };
    if (!moves[event.key]) return;
    event.preventDefault();
    const [turn, rise] = moves[event.key];
    const elevation = Math.min(90, Math.max(LOWEST, this.sun.elevation + rise));
    this.onDrag({ azimuth: wrap(this.sun.azimuth + turn), elevation }, performance.now());
  }

  show(sun, day) {
    this.sun = sun;
    const [x, y] = onSky({ ...sun, elevation: Math.max(LOWEST, sun.elevation) }, HORIZON);
    this.handle.setAttribute("cx", x);
    this.handle.setAttribute("cy", y);
    this.ray.setAttribute("d", `M0 0L${x.toFixed(2)} ${y.toFixed(2)}`);
    this.handle.classList.toggle("night", sun.elevation < 0);
    this.handle.setAttribute("aria-valuenow", sun.elevation.toFixed(1));
    this.handle.setAttribute("aria-valuetext", `azimuth ${sun.azimuth.toFixed(1)}°, elevation ${sun.elevation.toFixed(1)}°`);
    this.path.setAttribute("d", pathOnSky(day?.up ?? [], HORIZON));
  }
}
