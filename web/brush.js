// A brush on the picture: strokes of it become dabs of paint on the shell's thickness.

import { meet, placeAt, ray } from "./projection.js";
import { length, add } from "./vector.js";

const THIN = [1, 0.6, 0.2, 1];
const THICK = [0.4, 1, 0.6, 1];
const SIGNIFICANT = 5;

const rounded = (values) => values.map((value) => Number(value.toPrecision(SIGNIFICANT)));

/** The pointer and the keys as a brush; `tell` says in words what came of it, `show` draws rings where it is. */
export class Brush {
  constructor(stage, pointer, store, tell, show) {
    Object.assign(this, { surface: pointer.surface, pointer, store, tell, show });
    this.on = false;
    this.radius = 0.2;
    this.factor = 0.5;
    this.stroke = null;
    this.hover = null;
    const early = (name, handler) => stage.addEventListener(name, (event) => this.on && event.target === this.surface && handler.call(this, event), { capture: true });
    early("pointerdown", this.down);
    early("pointermove", this.move);
    early("pointerup", this.up);
    early("pointercancel", this.up);
    early("pointerout", () => this.point(null));
    early("keydown", this.key);
  }

  /** What a shell is built of, for the places that the brush meets. */
  take(outline) {
    this.outline = outline;
  }

  get paint() {
    return this.store.document.extrusion.paint;
  }

  get most() {
    return this.store.schema.at("extrusion.paint", this.store.document).maxItems;
  }

  /** Where the ray through a point of the window meets the shell's top. */
  under(x, y) {
    if (!this.outline) return null;
    const { positions, rest, faces } = this.outline;
    const box = this.surface.getBoundingClientRect();
    const line = ray(this.store.document.camera, box.width / box.height, (x - box.left) / box.width, (y - box.top) / box.height);
    const top = rest.length / 3;
    const found = meet(line, positions, faces, top);
    return found && { at: placeAt(found, positions, faces, top), rest: rounded(placeAt(found, rest, faces)), normal: found.normal };
  }

  rings() {
    const colour = this.factor < 1 ? THIN : THICK;
    const places = [...(this.stroke?.places ?? []), ...(this.hover ? [this.hover] : [])];
    return places.map(({ at, normal }) => ({ at, normal, radius: this.radius, colour }));
  }

  point(place) {
    if (!place && !this.hover) return;
    this.hover = place;
    this.show();
  }

  /** One finger paints where there is something to paint on; elsewhere, and with two, it moves the camera. */
  down(event) {
    if (this.stroke) {
      this.pointer.down(this.stroke.event); // the second finger: both move the camera
      this.stroke = null;
      this.point(null);
      return;
    }
    if (event.button !== 0 || event.shiftKey || this.pointer.pointers.size) return;
    const place = this.under(event.clientX, event.clientY);
    if (!place) return;
    event.stopPropagation();
    this.surface.focus({ preventScroll: true });
    this.surface.setPointerCapture(event.pointerId);
    this.stroke = { event, id: event.pointerId, places: [] };
    this.add(place);
  }

  move(event) {
    if (this.stroke && event.pointerId !== this.stroke.id) return;
    if (!this.stroke && this.pointer.pointers.size) return;
    const place = this.under(event.clientX, event.clientY);
    this.hover = place;
    if (this.stroke) {
      event.stopPropagation();
      if (place) this.add(place);
    }
    this.show();
  }

  /** Dabs stand one radius apart: between two of them their paint together is as strong as in their middles. */
  add(place) {
    const { places } = this.stroke;
    if (places.length + this.paint.length >= this.most) this.stroke.full = true;
    else if (places.every(({ at }) => length(add(at, place.at, -1)) >= this.radius)) places.push(place);
    this.show();
  }

  up(event) {
    if (!this.stroke || event.pointerId !== this.stroke.id) return;
    event.stopPropagation();
    const { places, full } = this.stroke;
    this.stroke = null;
    if (event.type === "pointerup") this.keep(places, full);
    if (event.pointerType === "touch") this.hover = null;
    this.show();
  }

  /** A stroke becomes part of the document: one step of undo. */
  keep(places, full = false) {
    const { paint, most } = this;
    const fresh = places.map(({ rest }) => ({ at: rest, radius: this.radius, factor: this.factor }));
    if (fresh.length) this.store.change({ extrusion: { paint: [...paint, ...fresh] } }, `paint ${paint.length}`);
    const count = paint.length + fresh.length;
    if (full) this.tell(`The shell holds ${most} dabs of paint and no more: undo, or take some off.`);
    else if (fresh.length) this.tell(`${count} of ${most} dabs of paint.`);
  }

  /** Enter paints in the middle of the picture, brackets make the brush smaller and larger. */
  key(event) {
    if (event.code !== "Enter" || event.ctrlKey || event.metaKey || event.altKey) return;
    event.stopPropagation();
    event.preventDefault();
    const box = this.surface.getBoundingClientRect();
    const place = this.under(box.left + box.width / 2, box.top + box.height / 2);
    if (!place) this.tell("The middle of the picture shows no shell: turn it there first.");
    else this.keep(this.paint.length < this.most ? [place] : [], this.paint.length >= this.most);
    this.point(place);
  }
}
