// A study of the sun over the land that is shown: for a range of days, maps of hours and of energy, to read and to keep.

import * as api from "./api.js";
import { el, freshId, humanise, numberIn, segments } from "./dom.js";
import { Progress } from "./notices.js";

const FIRST = ["start", "end", "receiver", "latitude", "longitude"];
const MAPS = [["hours", "Hours of sun"], ["insolation", "Insolation"]];
const HEADER_AT = 8;
const TALLEST = 46;
const round = (value) => value.toLocaleString("en", { maximumFractionDigits: Math.abs(value) < 10 ? 1 : 0 });

/** The float32 values of a two-dimensional `.npy`, row by row, and how many columns it has. */
async function numbersOf(url) {
  const buffer = await (await fetch(url)).arrayBuffer();
  const start = HEADER_AT + 2 + new DataView(buffer).getUint16(HEADER_AT, true);
  const [, columns] = /\((?:\d+), (\d+)\)/.exec(new TextDecoder().decode(buffer.slice(HEADER_AT + 2, start)));
  return { values: new Float32Array(buffer.slice(start)), columns: Number(columns) };
}

/** What the dialog shows; a study goes on while the dialog is closed. */
export class SunStudy {
  constructor(store) {
    this.store = store;
    this.entries = new Map();
  }

  async fill(root) {
    this.root ??= await this.build();
    root.replaceChildren(this.root);
  }

  async build() {
    const { schema: { properties } } = (await api.quantities()).find(({ name }) => name === "sunlight");
    const { sun } = this.store.document;
    if (sun.kind === "moment") for (const name of ["latitude", "longitude", "time_zone"]) properties[name].default = sun[name];
    const rest = Object.keys(properties).filter((name) => name !== "points" && !FIRST.includes(name));
    const rows = (names) => el("div", { class: "pairs" }, names.map((name) => this.entry(name, properties[name])));
    this.progress = new Progress(() => this.abort.abort());
    this.progress.root.hidden = true;
    this.error = el("p", { class: "field-error", role: "alert" });
    this.found = el("div", { class: "form" });
    return el("div", { class: "form" },
      el("p", { text: "How long the sun reaches each place of this land, and what it sends there under a cloudless sky." }),
      rows(FIRST),
      el("details", { class: "fold" }, el("summary", {}, el("h3", { text: "More" })), rows(rest)),
      el("button", { type: "button", class: "wide", text: "Study the sun", on: { click: () => this.study() } }),
      this.progress.root, this.error, this.found);
  }

  entry(name, node) {
    const id = freshId("study");
    const unit = node.umbrage?.unit;
    const shared = { id, title: node.description, value: node.default ?? "" };
    const field = node.enum ? el("select", { class: "select", ...shared }, node.enum.map((word) => el("option", { value: word, text: humanise(word) })))
      : el("input", { class: "text", placeholder: node.default === null ? "the land's own" : null, ...shared,
        type: unit === "date" ? "date" : "text", ...(name === "time_zone" ? { list: "time-zones" } : {}) });
    if (node.enum) field.value = node.default;
    this.entries.set(name, { field, text: node.type === "string" });
    return el("div", { class: "control" }, el("label", { class: "label", for: id, text: node.title + (unit === "deg" ? " (°)" : "") }), field);
  }

  period() {
    const given = [...this.entries].filter(([, { field }]) => field.value !== "");
    return Object.fromEntries(given.map(([name, { field: { value }, text }]) => [name, text || Number.isNaN(numberIn(value)) ? value : numberIn(value)]));
  }

  async study() {
    this.abort?.abort();
    const abort = this.abort = new AbortController();
    this.error.textContent = "";
    this.progress.root.hidden = false;
    this.progress.show({ words: "Waiting for its turn", fraction: 0 });
    try {
      this.show(await api.job({ kind: "sunlight", state: this.store.document, period: this.period() }, (progress) => this.progress.show(progress), abort.signal));
    } catch (error) {
      if (error.name !== "AbortError") this.error.textContent = error.message;
    } finally {
      if (this.abort === abort) this.progress.root.hidden = true;
    }
  }

  /** The maps, one at a time, with their scale and the value under the pointer. */
  show(result) {
    const { arguments: { start, end }, size_m: [width, height], notes, hours_on_a_plain: plain } = result.meta;
    const map = el("img", { class: "map" });
    map.style.aspectRatio = width / height;
    map.style.width = `min(100%, ${TALLEST * width / height}dvh)`;
    const bar = el("span", { class: "scale-bar" });
    const ends = el("span", { class: "scale-ends" });
    const line = el("output", { class: "hint-facts" });
    const files = el("p", { class: "hint-facts" });
    const { radios, group } = segments("Map", MAPS, async (name) => {
      const { lowest, mean, highest, colours, unit } = result[name];
      const words = unit.replace("m-2", "m⁻²");
      const rest = `${start} to ${end}: ${round(mean)} ${words} in the mean`;
      Object.assign(map, { src: result.files[`${name}.png`], alt: `Map of ${name}, north up: ${round(lowest)} to ${round(highest)} ${words}` });
      bar.style.background = `linear-gradient(90deg, ${colours})`;
      ends.replaceChildren(...[lowest, (lowest + highest) / 2, highest].map((value) => el("span", { text: `${round(value)} ${words}` })));
      line.textContent = rest;
      files.replaceChildren(...["tif", "png", "npy"].flatMap((suffix) => [el("a", { href: result.files[`${name}.${suffix}`],
        download: `${name}_${start}_${end}.${suffix}`, text: { tif: "GeoTIFF", png: "PNG", npy: "NumPy array" }[suffix] }), " "]));
      map.onpointermove = map.onpointerleave = null;
      const { values, columns } = await numbersOf(result.files[`${name}.npy`]);
      map.onpointermove = ({ offsetX, offsetY }) => {
        const column = Math.floor((offsetX / map.clientWidth) * columns);
        const row = Math.floor((offsetY / map.clientHeight) * (values.length / columns));
        const value = values[row * columns + column];
        line.textContent = value >= 0 ? `Here ${round(value)} ${words}` : "Under trees";
      };
      map.onpointerleave = () => { line.textContent = rest; };
    });
    this.found.replaceChildren(group, map, bar, ends, line, files,
      el("p", { class: "hint-facts", text: `A plain would have ${round(plain)} h. Assumed: ${notes.join("; ")}.` }));
    radios[0].click();
    this.found.scrollIntoView({ block: "nearest" });
  }
}
