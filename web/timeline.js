// The bar at the bottom: time of day with sunrise and sunset, play, date and place; the dome beside it always agrees.

import { el, freshId, icon, iconButton, say } from "./dom.js";
import { UnionPart } from "./form.js";
import { clock, compass, Days, Dome, minutesOf } from "./sun.js";

const LAST_MINUTE = 1439;
const PLAY_MINUTES_PER_SECOND = 36;
const TWILIGHT = 25;
const DAWN = 45;

/** Sun bar; reads and writes `sun` of the store's document. */
export class SunBar {
  constructor(root, store, link, context) {
    Object.assign(this, { root, store, link, context });
    this.days = new Days();
    this.day = null;
    this.dome = new Dome(root.querySelector("#dome"), (sun, time) => this.aim(sun, time), (active) => link.send({ type: "moving", active }));
    this.build();
    store.addEventListener("scene", () => this.forget());
  }

  build() {
    this.clock = el("output", { class: "clock" });
    this.note = el("span", { class: "sun-note" });
    this.range = el("input", { type: "range", min: 0, max: LAST_MINUTE, step: 1, class: "day", "aria-label": "Time of day",
      on: { input: () => this.tell(Number(this.range.value), performance.now()) } });
    this.rise = el("span", { class: "day-mark", hidden: true });
    this.set = el("span", { class: "day-mark", hidden: true });
    this.play = iconButton("play", "Play the day", () => (this.playing ? this.stop() : this.start()), { "aria-pressed": "false" });
    this.date = el("input", { type: "date", class: "text", "aria-label": "Date", on: { change: () => this.date.value && this.moment({ date: this.date.value }) } });
    const details = freshId("place");
    this.placeText = el("span", {});
    this.placeButton = el("button", { type: "button", class: "place-button", "aria-expanded": "false", "aria-controls": details,
      "aria-label": "Sun, date and place in numbers", on: { click: () => this.unfold(this.details.hidden) } }, icon("place"), this.placeText);
    this.details = el("div", { id: details, class: "glass popover place", hidden: true, role: "group", "aria-label": "Sun, date and place" });
    this.root.querySelector("#timeline").append(
      el("div", { class: "time-row" }, this.play, this.clock, this.note, el("span", { class: "spacer" }), this.date, this.placeButton),
      el("div", { class: "day-track" }, this.range, this.rise, this.set));
    this.root.append(this.details);
    this.root.addEventListener("keydown", (event) => {
      if (event.key !== "Escape" || this.details.hidden) return;
      this.unfold(false);
      this.placeButton.focus();
    });
  }

  unfold(open) {
    this.details.hidden = !open;
    this.placeButton.setAttribute("aria-expanded", String(open));
  }

  /** A scene was loaded: numbers of its sun union, generated like every other control. */
  forget() {
    this.union = new UnionPart(this.context(), "sun", this.store.schema.at("sun", this.store.document));
    this.details.replaceChildren(this.union.root);
    this.remembered = null;
    this.refresh();
  }

  /** The moment in the document, or the last one, or the scene's own. */
  get last() {
    const { document, scene, schema } = this.store;
    if (document.sun.kind === "moment") this.remembered = document.sun;
    if (!this.remembered) {
      const fresh = schema.fresh(schema.members(schema.at("sun", document)).get("moment"));
      this.remembered = scene.defaults.sun.kind === "moment" ? scene.defaults.sun : fresh;
    }
    return this.remembered;
  }

  /** Change the moment; in direction mode this returns to date and time. */
  moment(patch, source = "sun.moment", time = performance.now()) {
    const free = this.store.document.sun.kind !== "moment";
    this.store.change({ sun: free ? { ...this.last, ...patch } : patch }, source, time);
  }

  tell(minutes, time) {
    this.moment({ time: clock(minutes) }, "sun.time", time);
  }

  /** The dome was dragged: the sun is placed by hand. */
  aim(sun, time) {
    const { schema, document } = this.store;
    this.stop();
    const rounded = { azimuth: Number(sun.azimuth.toFixed(2)), elevation: Number(sun.elevation.toFixed(2)) };
    const free = document.sun.kind === "direction";
    if (!free) this.remembered = document.sun;
    const fresh = free ? {} : schema.fresh(schema.members(schema.at("sun", document)).get("direction"));
    this.store.change({ sun: { ...fresh, ...rounded } }, "sun.dome", time);
  }

  start() {
    this.playing = true;
    this.button("pause", "Pause", true);
    this.link.send({ type: "moving", active: true });
    let before = performance.now();
    let minutes = this.minutes;
    const from = Math.max(0, (this.day?.sunrise ?? 0) - DAWN);
    const to = Math.min(LAST_MINUTE, (this.day?.sunset ?? LAST_MINUTE) + DAWN);
    const tick = (now) => {
      if (!this.playing) return;
      minutes += ((now - before) / 1000) * PLAY_MINUTES_PER_SECOND;
      before = now;
      if (minutes > to || minutes < from) minutes = from;
      this.tell(minutes, performance.now());
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  stop() {
    if (!this.playing) return;
    this.playing = false;
    this.button("play", "Play the day", false);
    this.link.send({ type: "moving", active: false });
  }

  button(name, label, pressed) {
    this.play.replaceChildren(icon(name));
    this.play.setAttribute("aria-label", label);
    this.play.title = label;
    this.play.setAttribute("aria-pressed", String(pressed));
  }

  async refresh(all = true) {
    const { document } = this.store;
    if (!document || !this.union || !all && document.sun === this.shown) return;
    this.shown = document.sun;
    this.draw();
    const wanted = this.last;
    const day = await this.days.get(wanted).catch(() => null);
    if (wanted !== this.last || day === this.day) return;
    this.day = day;
    this.draw();
  }

  draw() {
    const { sun } = this.store.document;
    const free = sun.kind === "direction";
    this.minutes = free ? (this.day?.nearest(sun) ?? 720) : minutesOf(sun.time);
    const placed = this.placed = free ? sun : (this.day?.at(this.minutes) ?? null);
    this.root.classList.toggle("free", free);
    say(this.clock, free ? "by hand" : sun.time.slice(0, 5));
    say(this.note, placed ? `${compass(placed.azimuth)} ${placed.azimuth.toFixed(0)}°, ${placed.elevation.toFixed(1)}° high` : "");
    if (!this.range.matches(":active")) this.range.value = this.minutes;
    this.range.setAttribute("aria-valuetext", free ? "sun placed by hand" : sun.time.slice(0, 5));
    if (placed) this.dome.show(placed, this.day);
    this.marks();
    const { date, latitude, longitude } = this.last;
    if (this.date !== window.document.activeElement) this.date.value = date;
    const place = `${Math.abs(latitude).toFixed(1)}° ${latitude < 0 ? "S" : "N"}, ${Math.abs(longitude).toFixed(1)}° ${longitude < 0 ? "W" : "E"}`;
    say(this.placeText, place);
    this.union.refresh(this.store.document);
  }

  marks() {
    for (const [mark, minutes, word] of [[this.rise, this.day?.sunrise, "↑"], [this.set, this.day?.sunset, "↓"]]) {
      mark.hidden = !Number.isFinite(minutes);
      if (mark.hidden) continue;
      say(mark, `${word} ${clock(minutes).slice(0, 5)}`);
      mark.title = word === "↑" ? "Sunrise" : "Sunset";
      mark.style.setProperty("--at", minutes / LAST_MINUTE);
    }
    const { sunrise, sunset } = this.day ?? {};
    const known = Number.isFinite(sunrise);
    this.range.classList.toggle("known", known);
    if (!known) return;
    for (const [name, minutes] of [["dawn", sunrise - TWILIGHT], ["rise", sunrise + TWILIGHT], ["fall", sunset - TWILIGHT], ["dusk", sunset + TWILIGHT]]) {
      this.range.style.setProperty(`--${name}`, `${((100 * minutes) / LAST_MINUTE).toFixed(2)}%`);
    }
  }
}
