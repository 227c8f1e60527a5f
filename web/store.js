// The page's copy of the state document: what the person sees at once, what the server has accepted, undo and redo.

import { merge, same } from "./document.js";

const GESTURE_GAP_MS = 600;
const HISTORY_LENGTH = 200;

/** Holds the document; every change of it, from any control, goes through here. */
export class Store extends EventTarget {
  constructor() {
    super();
    this.document = null;
    this.accepted = null;
    this.schema = null;
    this.scene = null;
    this.past = [];
    this.future = [];
    this.lastChange = { at: -Infinity, source: "" };
  }

  /** Load a scene's description; controls are rebuilt. */
  describe(scene) {
    this.scene = scene;
    this.dispatchEvent(new Event("scene"));
  }

  /** Take the server's document as ours, as after joining. */
  adopt(document) {
    this.accepted = document;
    this.document = document;
    this.announce("server");
  }

  /** The server accepted a change. Ours stays ahead while `waiting` says that later changes are on their way. */
  accept(document, waiting) {
    this.accepted = document;
    if (waiting || same(document, this.document)) return;
    this.document = document;
    this.announce("server");
  }

  /** The server refused a change: back to what it has, plus what is still on its way. */
  refuse(unsent) {
    this.document = unsent ? merge(this.accepted, unsent) : this.accepted;
    if (same(this.past.at(-1), this.document)) this.past.pop();
    this.lastChange = { at: -Infinity, source: "" };
    this.announce("server");
  }

  /**
   * Change the document by a merge patch.
   * `source` names the control; changes from one control in quick succession are one step of undo.
   */
  change(patch, source = "", time = performance.now()) {
    if (!this.document) return;
    const after = merge(this.document, patch);
    if (same(after, this.document)) return;
    const now = performance.now();
    if (source !== this.lastChange.source || now - this.lastChange.at > GESTURE_GAP_MS) this.remember();
    this.lastChange = { at: now, source };
    this.document = after;
    this.dispatchEvent(new CustomEvent("patch", { detail: { patch, time } }));
    this.announce(source);
  }

  /** Replace the whole document, as a preset, an undo or a pasted link does. */
  replace(document, keepHistory = true) {
    if (keepHistory) this.remember();
    this.lastChange = { at: -Infinity, source: "" };
    this.document = document;
    this.dispatchEvent(new CustomEvent("replace", { detail: { document, time: performance.now() } }));
    this.announce("replace");
  }

  remember() {
    this.past.push(this.document);
    if (this.past.length > HISTORY_LENGTH) this.past.shift();
    this.future = [];
  }

  undo() {
    this.step(this.past, this.future);
  }

  redo() {
    this.step(this.future, this.past);
  }

  step(from, to) {
    if (!from.length) return;
    to.push(this.document);
    this.replace(from.pop(), false);
  }

  announce(source) {
    this.dispatchEvent(new CustomEvent("change", { detail: { source } }));
  }
}

