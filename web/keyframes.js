// Key frames of a shell on a track of their round: added where time stands, moved, taken out, each with its own values.

import { patchOf, withItem } from "./document.js";
import { el, follow, icon, iconButton, say, segments } from "./dom.js";
import { controlFor, written } from "./controls.js";
import { Form } from "./form.js";
import { within } from "./list.js";

const PATH = "course.keys";
const STEP_S = 0.1;
const LARGE_STEP_S = 1;
const DIGITS = 2;
const SURFACE = [["computed", "Exact"], ["interpolated", "Interpolated"], ["own", "Not by these"]];

/** What key frames say at a time of their round: even between two, and from the last on to the first of the next. */
export function keyAt(keys, period, place) {
  const rising = [...keys].sort((a, b) => a.at - b.at);
  const late = rising.findIndex((key) => key.at > place);
  const [one, other] = late > 0 ? [rising[late - 1], rising[late]] : [rising.at(-1), rising[0]];
  const begin = late === 0 ? Math.min(one.at - period, 0) : one.at;
  const end = late < 0 ? other.at + period : other.at;
  const share = end > begin ? (place - begin) / (end - begin) : 0;
  return Object.fromEntries(Object.keys(one).map((name) => [name, name === "at" ? place : Number((one[name] + share * (other[name] - one[name])).toPrecision(4))]));
}

/** The editor of key frames: a part of the shell editor. */
export class KeyFrames {
  constructor(context, run) {
    Object.assign(this, { context, run, chosen: null });
    const { store } = context;
    this.play = iconButton("play", "Let time run", () => run((made) => (made.running ? made.stop() : made.start())), { "aria-pressed": "false" });
    run((made) => made.addEventListener("running", () => this.running(made.running)));
    this.clock = el("output", { class: "unit" });
    this.add = el("button", { type: "button", class: "quiet", text: "Add here", on: { click: () => this.insert() } });
    this.remove = el("button", { type: "button", class: "quiet", text: "Take out", on: { click: () => this.take(this.chosen) } });
    this.head = el("input", { type: "range", min: 0, step: 0.01, "aria-label": "Time within the round",
      on: { input: () => store.change({ time: Number(this.head.value) }, "time") } });
    this.marks = el("div", { class: "key-marks" });
    const surface = segments("Surface between key frames", SURFACE, (value) => this.move(value));
    this.radios = surface.radios;
    this.period = controlFor(context, "course.period", context.schema.at("course.period", store.document));
    this.holder = el("div", {});
    this.help = el("p", { class: "facts", text: "Drag a mark, or move it with the arrow keys; Delete takes it out." });
    this.root = el("div", { class: "form key-frames" },
      el("div", { class: "control-head" }, this.play, this.clock, el("span", { class: "label" }), this.add, this.remove),
      el("div", { class: "key-track" }, this.head, this.marks), this.help, this.holder,
      el("div", { class: "control" }, el("span", { class: "label", text: "Surface between key frames" }), surface.group), this.period.root);
  }

  get course() {
    return this.context.store.document.course;
  }

  /** Time within the round. */
  get place() {
    const { time, course } = this.context.store.document;
    return Number((time % course.period).toFixed(DIGITS));
  }

  set(keys, source = PATH) {
    this.context.store.change(patchOf(PATH, keys), source);
  }

  /** A key frame where time stands, with what the others say there. */
  insert() {
    const { keys, period } = this.course;
    const { schema, store } = this.context;
    const fresh = schema.defaultOf(schema.resolve(schema.at(PATH, store.document).items));
    const key = keys.length ? { ...fresh, ...keyAt(keys.map((one) => ({ ...fresh, ...one })), period, this.place) } : { ...fresh, at: this.place };
    this.chosen = keys.length;
    this.set([...keys, key]);
  }

  take(index) {
    if (index === null) return;
    this.chosen = null;
    this.set(this.course.keys.toSpliced(index, 1));
    this.add.focus();
  }

  choose(index) {
    this.chosen = index;
    const { at } = this.course.keys[index];
    if (at <= this.course.period) this.context.store.change({ time: at % this.course.period }, "time");
    this.refresh(this.context.store.document);
  }

  /** Put a key frame at another time of the round. */
  shift(index, at) {
    const inside = Number(Math.min(this.course.period, Math.max(0, at)).toFixed(DIGITS));
    this.set(withItem(this.course.keys, index, { at: inside }), `${PATH}.${index}.at`);
  }

  move(value) {
    const { motion } = this.context.store.document;
    if (value === "own" ? motion.kind === "keys" : motion.kind !== "keys" || motion.planes !== value) {
      this.context.store.change({ motion: value === "own" ? { kind: "still" } : { kind: "keys", planes: value } }, "motion.kind");
    }
  }

  running(on) {
    this.play.replaceChildren(icon(on ? "pause" : "play"));
    this.play.setAttribute("aria-pressed", String(on));
    this.play.setAttribute("aria-label", on ? "Hold time" : "Let time run");
    this.play.title = this.play.getAttribute("aria-label");
  }

  mark(index) {
    const seconds = (event) => {
      const { left, width } = this.marks.getBoundingClientRect();
      return ((event.clientX - left) / width) * this.course.period;
    };
    const down = (event) => {
      this.choose(index);
      follow(node, event, (move) => this.shift(index, seconds(move)));
    };
    const key = (event) => {
      const way = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (way) this.shift(index, this.course.keys[index].at + way * (event.shiftKey ? LARGE_STEP_S : STEP_S));
      else if (["Delete", "Backspace"].includes(event.key)) this.take(index);
      else return;
      event.preventDefault();
      event.stopPropagation();
    };
    const node = el("button", { type: "button", class: "key-mark", on: { pointerdown: down, keydown: key, click: () => this.choose(index) } });
    return node;
  }

  refresh(document) {
    const { keys, period } = document.course;
    if (this.chosen !== null && this.chosen >= keys.length) this.chosen = null;
    if (this.marks.children.length !== keys.length) this.marks.replaceChildren(...keys.map((_, index) => this.mark(index)));
    keys.forEach((key, index) => {
      const node = this.marks.children[index];
      node.style.setProperty("--at", Math.min(key.at / period, 1));
      node.setAttribute("aria-label", `Key frame at ${written(key.at)} s`);
      node.setAttribute("aria-pressed", String(index === this.chosen));
    });
    this.head.max = period;
    if (!this.head.matches(":active")) this.head.value = this.place;
    say(this.clock, `${this.place.toFixed(1)} s of ${written(period)} s`);
    this.remove.disabled = this.chosen === null;
    this.help.hidden = !keys.length;
    const surface = document.motion.kind === "keys" ? document.motion.planes : "own";
    for (const radio of this.radios) radio.checked = radio.value === surface;
    this.period.refresh(document);
    this.values(document);
  }

  /** The controls of the chosen key frame. */
  values(document) {
    if (this.shown !== this.chosen) {
      this.form?.forget();
      this.form = null;
      this.shown = this.chosen;
      if (this.chosen !== null) {
        const { schema } = this.context;
        const node = schema.resolve(schema.at(PATH, document).items);
        this.form = new Form(within(this.context, PATH));
        this.form.addFields(`${PATH}.${this.chosen}`, node);
      }
      this.holder.replaceChildren(...(this.form ? [this.form.root] : []));
    }
    this.form?.refresh(document);
  }
}
