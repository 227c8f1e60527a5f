// A study of the sun over the land that is shown: for a range of days, maps of hours and of energy, to read and to keep.
// Fetched when first wanted.

import * as api from "./api.js";
import { el, scaleBar } from "./dom.js";
import { Form } from "./form.js";
import { Progress } from "./notices.js";
import { Schema } from "./schema.js";
import { Store } from "./store.js";

const TALLEST = 50;
const quiet = (...children) => el("p", { class: "hint-facts" }, children);

/** What the dialog shows; a study goes on while the dialog is closed. */
export class SunStudy {
  constructor(land) {
    this.land = land;
    this.period = new Store();
  }

  async fill(root) {
    this.root ??= await this.build();
    root.replaceChildren(this.root);
  }

  async build() {
    const schema = new Schema((await api.quantities()).find(({ name }) => name === "sunlight").schema);
    const { points, ...standard } = schema.defaultOf(schema.root);
    this.period.document = standard;
    this.controls = new Map();
    const form = new Form({ store: this.period, schema, controls: this.controls, defaultOf: (name) => standard[name] });
    for (const name of Object.keys(standard)) form.add(name, schema.at(name));
    this.period.addEventListener("change", () => form.refresh(this.period.document));
    form.refresh(standard);
    form.root.classList.add("pairs");
    this.progress = new Progress(() => this.abort.abort());
    this.progress.root.hidden = true;
    this.found = el("div", { class: "form", role: "status" });
    return el("div", { class: "form" }, form.root,
      el("button", { type: "button", class: "wide", text: "Study the sun", on: { click: () => this.study() } }), this.progress.root, this.found);
  }

  async study() {
    this.abort?.abort();
    const abort = this.abort = new AbortController();
    for (const control of this.controls.values()) control.fail("");
    this.found.replaceChildren();
    this.progress.root.hidden = false;
    this.progress.show({ words: "Waiting for its turn" });
    const work = { kind: "sunlight", state: this.land.document, period: this.period.document };
    try {
      this.show(await api.job(work, (progress) => this.progress.show(progress), abort.signal));
    } catch (error) {
      const control = this.controls.get(error.errors?.[0].field);
      if (control) control.fail(api.sentence({ ...error.errors[0], field: "" }));
      else if (error.name !== "AbortError") this.found.replaceChildren(el("p", { class: "field-error", text: error.message }));
    } finally {
      if (this.abort === abort) this.progress.root.hidden = true;
    }
  }

  /** Both maps, north up, each with its scale and its files. */
  show(result) {
    const { arguments: { start, end }, size_m: [width, height], notes, hours_on_a_plain: plain } = result.meta;
    const map = (name, title) => {
      const { lowest, mean, highest, colours, unit } = result[name];
      const said = (value) => `${Number(value.toPrecision(3))} ${unit.replace("m-2", "m⁻²")}`;
      const link = (suffix, text) => el("a", { href: result.files[`${name}.${suffix}`], download: `${name}_${start}_${end}.${suffix}`, text });
      return [el("h3", { text: `${title}, ${said(mean)} in the mean` }),
        el("img", { class: "map", src: result.files[`${name}.png`], alt: `Map of ${name}, north up`,
          style: { aspectRatio: width / height, width: `min(100%, ${(TALLEST * width) / height}dvh)` } }),
        ...scaleBar(colours, [lowest, (lowest + highest) / 2, highest].map(said)),
        quiet(link("tif", "GeoTIFF"), " ", link("png", "PNG"), " ", link("npy", "NumPy"))];
    };
    this.found.replaceChildren(...map("hours", "Hours of sun"), ...map("insolation", "Insolation"),
      quiet(`A plain would have ${plain} h. Assumed: ${notes.join("; ")}.`));
    this.found.scrollIntoView({ block: "start" });
  }
}
