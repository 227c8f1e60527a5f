// A file that was dropped or chosen is checked by the server and shown with its size before it replaces anything.
// Fetched with the first file.

import * as api from "./api.js";
import { el, humanise, numberIn, terms } from "./dom.js";
import { patchOf, valueAt } from "./document.js";
import { bytes } from "./overlay.js";
import { unitOf } from "./schema.js";

const MENDED = { "holes = fill": { words: "Fill the holes from their rims", reading: { holes: "fill" } } };

/** What a map of one quantity may come as: a picture and a GeoTIFF say nothing of what their numbers are. */
const MAPS = ["map", "image", "terrain"];

/**
 * Where in the state a file of `kind` may go: `{path, title, reading, patch(asset, reading)}` for every text field made
 * for such a file; `reading` is the schema of what the file may leave unsaid, where the state has a place for that.
 */
export function placesFor(schema, kind, document = {}) {
  const found = [];
  for (const [name, node] of schema.fields(schema.root)) {
    const title = node.title ?? humanise(name);
    const add = (field, inner, patch) => {
      const map = MAPS.includes(kind) && field.endsWith("_map");
      const own = inner.title;
      if (inner.umbrage?.takes?.includes(kind) ?? (map || [name, field].includes(kind))) found.push({ path: `${name}.${field}`, title: map ? own : title, patch, reading });
    };
    let reading = null;
    const sort = schema.sort(node);
    for (const member of sort === "union" ? schema.members(node).values() : []) {
      reading = new Map(schema.fields(member)).get("reading") ?? null;
      for (const [field, inner] of schema.fields(member)) {
        const fresh = () => schema.fresh(member);
        const read = (said) => ("reading" in fresh() ? { reading: { ...fresh().reading, ...said } } : {});
        if (schema.isAsset(inner)) add(field, inner, (asset, said) => ({ [name]: { ...fresh(), ...read(said), [field]: asset } }));
      }
    }
    for (const [field, inner] of sort === "object" ? schema.fields(node) : []) {
      if (schema.sort(inner) === "list") found.push(...placesIn(schema, kind, `${name}.${field}`, inner, valueAt(document, `${name}.${field}`) ?? []));
      if (schema.isAsset(inner)) add(field, inner, (asset) => ({ [name]: { [field]: asset } }));
    }
  }
  return found;
}

/** The same for a list, to which the file brings one more item. */
function placesIn(schema, kind, path, node, list) {
  const item = schema.resolve(node.items);
  const members = schema.sort(item) === "union" && list.length < node.maxItems ? [...schema.members(item).values()] : [];
  return members.flatMap((member) => schema.fields(member).filter(([, field]) => schema.isAsset(field) && field.umbrage?.takes?.includes(kind)).map(([field]) => {
    const reading = new Map(schema.fields(member)).get("reading");
    const fresh = schema.fresh(member);
    const patch = (asset, said) => patchOf(path, [...list, { ...fresh, ...(reading ? { reading: { ...fresh.reading, ...said } } : {}), [field]: asset }]);
    return { path, title: `one more of ${node.title}`, patch, reading };
  }));
}

/** The dialog of a file. */
export class Upload {
  constructor(dialog, show, store, notices) {
    Object.assign(this, { dialog, show, store, notices });
  }

  async take(file, reading = {}) {
    if (!file) return;
    this.notices.connection(`Checking ${file.name} (${bytes(file.size)}) …`);
    try {
      this.preview(file, await api.upload(file, reading));
    } catch (error) {
      const allowed = (error.errors ?? []).map((refusal) => refusal.allowed).join();
      const [, way] = Object.keys(reading).length ? [] : Object.entries(MENDED).find(([words]) => allowed.includes(words)) ?? [];
      if (way) this.offer(file, error.message, way);
      else this.notices.toast(`${file.name} was refused. ${error.message}`, "refusal");
    } finally {
      this.notices.connection(null);
    }
  }

  /** A file that was refused as it is, and could be read otherwise. */
  offer(file, sentence, { words, reading }) {
    const again = () => {
      this.dialog.close();
      this.take(file, reading);
    };
    this.show(file.name, el("p", { text: sentence }), el("button", { type: "button", class: "wide", text: words, on: { click: again } }));
  }

  preview(file, { asset, kind, preview = {}, reading = {} }) {
    const { still_to_say: unsaid = "", ...facts } = preview;
    const places = placesFor(this.store.schema, kind, this.store.document);
    const rows = Object.entries({ kind, size: bytes(file.size), ...facts }).filter(([, value]) => value !== null && value !== "");
    const asked = new Reading(this.store.schema, places.find((place) => place.reading)?.reading, unsaid);
    const use = places.map((place) => el("button", { type: "button", class: "wide", text: `Use for: ${place.title.toLowerCase()}`,
      on: { click: () => this.apply(place, asset, reading, asked) } }));
    const none = places.length ? null : el("p", { text: `This scene has no place for a file of this kind (${kind}).` });
    this.show(file.name,
      el("dl", { class: "costs" }, terms(rows.map(([name, value]) => [humanise(name), said(value)]))),
      ...asked.rows, ...use, ...(none ? [none] : []));
  }

  apply(place, asset, reading, asked) {
    const values = asked.values();
    if (values === null) return;
    this.store.change(place.patch(asset, { ...reading, ...values }), "upload");
    this.dialog.close();
  }
}

/** Entries for what a file leaves unsaid: one a number, from the schema of its reading. */
class Reading {
  constructor(schema, node, unsaid) {
    const known = new Map(node ? schema.fields(node) : []);
    this.fields = unsaid.split(", ").filter((name) => known.has(name)).map((name) => {
      const field = known.get(name);
      const count = schema.sort(field) === "vector" ? field.prefixItems.length : 1;
      const entries = Array.from({ length: count }, (_, number) => el("input", { type: "text", inputmode: "decimal", class: "entry",
        autocomplete: "off", "aria-label": count > 1 ? `${field.title}, ${"xyz"[number]}` : field.title }));
      return { name, field, entries };
    });
    this.error = el("p", { class: "field-error", role: "alert", hidden: true });
    this.rows = this.fields.map(({ field, entries }) => el("div", { class: "control" }, el("div", { class: "control-head" },
      el("span", { class: "label", text: field.title }), entries.map((entry) => el("span", { class: "number" }, entry, el("span", { class: "unit", text: unitOf(field) }))))));
    if (this.rows.length) this.rows.push(this.error);
  }

  /** What was entered, or null where something is missing, which is then said. */
  values() {
    const found = {};
    for (const { name, field, entries } of this.fields) {
      const numbers = entries.map((entry) => numberIn(entry.value));
      if (!numbers.every(Number.isFinite)) {
        this.error.textContent = `${field.title}: the file does not say it, so it must be entered.`;
        this.error.hidden = false;
        entries[0].focus();
        return null;
      }
      found[name] = numbers.length > 1 ? numbers : numbers[0];
    }
    return found;
  }
}

/** A fact of the preview in one line. */
function said(value) {
  if (Array.isArray(value)) return value.map(said).join(" × ");
  if (typeof value === "number") return String(Number(value.toPrecision(6)));
  if (value !== null && typeof value === "object") return Object.entries(value).map(([key, item]) => `${humanise(key)} ${said(item)}`).join(", ");
  return String(value);
}
