// Scenes and presets as a strip of real thumbnails, drawn by the server when the strip is first opened.

import * as api from "./api.js";
import { el, humanise, say, segments } from "./dom.js";
import { same } from "./document.js";

const WIDTH = 320;
const HEIGHT = 200;

/** The strip under the top bar. */
export class Gallery {
  constructor(root, button, store, choose) {
    Object.assign(this, { root, button, store, choose });
    button.addEventListener("click", () => this.unfold(root.hidden));
    root.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      this.unfold(false);
      button.focus();
    });
    store.addEventListener("change", () => this.name());
    store.addEventListener("scene", () => this.changed());
  }

  async load() {
    this.scenes = await api.scenes();
  }

  unfold(open) {
    this.root.hidden = !open;
    this.button.setAttribute("aria-expanded", String(open));
    if (open) this.build();
  }

  /** Another scene was chosen: its presets, in the strip that is still open. */
  changed() {
    this.name();
    if (this.root.hidden) return;
    this.build();
    this.root.querySelector("input:checked")?.focus({ preventScroll: true });
  }

  /** Scene and preset now shown; a preset keeps its name until something in the picture changes. */
  name() {
    const { scene, document } = this.store;
    if (!scene || !document) return;
    const shown = (state) => ({ ...state, quality: null });
    const match = Object.values(scene.presets).find((preset) => same(shown(preset.document), shown(document)));
    say(this.button.querySelector(".scene-name"), scene.title);
    say(this.button.querySelector(".preset-name"), match?.title ?? "own view");
  }

  build() {
    const { scene } = this.store;
    if (!scene) return;
    const { radios, group } = segments("Scene", (this.scenes ?? []).map((item) => [item.name, item.title]), (name) => this.choose(name, null));
    for (const radio of radios) radio.checked = radio.value === scene.name;
    group.hidden = radios.length < 2;
    const cards = Object.entries(scene.presets).map(([name, preset]) => this.card(scene, name, preset));
    this.root.replaceChildren(group, el("div", { class: "strip", role: "group", "aria-label": `Presets of ${scene.title}` }, cards));
    this.root.querySelector("button")?.focus({ preventScroll: true });
  }

  card(scene, name, preset) {
    const src = `api/scenes/${encodeURIComponent(scene.name)}/presets/${encodeURIComponent(name)}/thumbnail.jpg`;
    const image = el("img", { alt: "", width: WIDTH, height: HEIGHT, src });
    return el("button", { type: "button", class: "thumbnail", on: { click: () => this.pick(name) } },
      image, el("span", { class: "thumbnail-title", text: preset.title ?? humanise(name) }), el("span", { class: "thumbnail-help", text: preset.help ?? "" }));
  }

  pick(name) {
    this.unfold(false);
    this.button.focus();
    this.choose(this.store.scene.name, name);
  }
}
