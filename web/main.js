// Puts the page together; every module gets what it needs from here and knows no other by name. What the first picture
// does not need is fetched when it is first wanted.

import * as api from "./api.js";
import { el, iconButton, perFrame } from "./dom.js";
import { Drop } from "./drop.js";
import { Frames } from "./frames.js";
import { Gallery } from "./gallery.js";
import { Notices } from "./notices.js";
import { Overlay } from "./overlay.js";
import { Panels, schemaOf } from "./panels.js";
import { Pointer } from "./pointer.js";
import { Screen } from "./screen.js";
import { decode, Share } from "./share.js";
import { Link } from "./socket.js";
import { Stats } from "./stats.js";
import { Store } from "./store.js";
import * as theme from "./theme.js";
import { SunBar } from "./timeline.js";

const NARROW = "(max-width: 799px)";
const DRAGGED_MS = 150;
const find = (selector) => document.querySelector(selector);

const store = new Store();
const stats = new Stats();
const screen = new Screen(find("#stage"));
let opening = { state: null, scene: null, preset: null };
const link = new Link(store, () => ({ width: screen.width, height: screen.height, ...opening, ...(store.document ? { state: store.document } : {}) }));
const notices = new Notices(find("#notices"), link);
const pointer = new Pointer(find("#surface"), store, link);
const panels = new Panels(find("#controls"), find("#hint"), store, () => pointer.aspect, () => drop.choose());
const sunBar = new SunBar(find("#sun"), store, link, () => panels.context());
const gallery = new Gallery(find("#gallery"), find("#scene"), store, choose);
const share = new Share(store, notices);
const dialog = find("#dialog");
const drop = new Drop((file) => upload((part) => part.take(file)));
new Frames(link, screen, stats);
new Overlay(find("#corner"), stats);

/** Show a dialog; its body. */
function show(title, ...content) {
  const body = dialog.querySelector(".dialog-body");
  dialog.querySelector("h2").textContent = title;
  body.replaceChildren(...content);
  if (!dialog.open) dialog.showModal();
  return body;
}

/** A part of the page that is fetched when it is first wanted: what is returned hands it to whoever wants it. */
function part(load, make) {
  let made = null;
  return async (use) => {
    const module = await load().catch(() => null);
    if (!module) return notices.toast("This part of the page could not be fetched: try again.", "refusal");
    made ??= make(module);
    return use(made);
  };
}

const close = () => dialog.close();
const help = part(() => import("./help.js"), (module) => module);
const doors = part(() => import("./doors.js"), ({ Doors }) => new Doors(store, screen, notices, share));
const upload = part(() => import("./upload.js"), ({ Upload }) => new Upload(dialog, show, store, notices));
const sunStudy = part(() => import("./sunstudy.js"), ({ SunStudy }) => new SunStudy(store));
const probe = part(() => import("./probe.js"), ({ Probe }) => new Probe(find("#probe"), link, store, () => sunBar));
const compare = part(() => import("./compare.js"), ({ Compare }) => (window.umbrage.compare = new Compare(find("#compare"), screen, store, link, notices)));
const runner = part(() => import("./running.js"), ({ Runner }) => new Runner(find("#timeline .time-row"), store, link));
const editor = part(() => import("./shelleditor.js"), ({ ShellEditor }) => (window.umbrage.editor = new ShellEditor(find("#editor"), { screen, store, link, stats, pointer, notices, context: () => panels.context(), run: runner })));
const studies = part(() => import("./studies.js"), ({ Studies }) => new Studies(store, open));

const tools = {
  undo: iconButton("undo", "Undo", () => store.undo()),
  redo: iconButton("redo", "Redo", () => store.redo()),
  compare: iconButton("compare", "Compare", () => compare(() => unfold("compare")), { "aria-expanded": "false", "aria-controls": "compare" }),
  editor: iconButton("brush", "Edit the shell", () => editor(() => unfold("editor")), { "aria-expanded": "false", "aria-controls": "editor", hidden: true }),
  sunlight: iconButton("sun", "Study the sun over days", () => sunStudy((made) => made.fill(show("Sun study")))),
  study: iconButton("chart", "Failures, charts and tables", () => studies((made) => made.fill(show("How right it is, and where it fails")))),
  open: iconButton("open", "Open a file", () => drop.choose()),
  share: iconButton("share", "Copy a link to this picture", () => share.copyLink()),
  export: iconButton("export", "Export", () => doors((made) => made.fillExport(show("Export"), close))),
  code: iconButton("code", "As code", () => doors((made) => made.fillCode(show("This picture as code")))),
  theme: iconButton("theme", "Dark or light", () => notices.toast(theme.next())),
  help: iconButton("help", "Help", () => help((made) => made.fill(show("What you can do")))),
  panel: iconButton("panel", "Techniques and parameters", () => unfold("panel"), { "aria-expanded": "true", "aria-controls": "panel" }),
};

/** Open or close a side panel; those on the left take turns, and on a phone all sheets do. */
function unfold(name, open = find(`#${name}`).hidden) {
  find(`#${name}`).hidden = !open;
  tools[name].setAttribute("aria-expanded", String(open));
  document.body.classList.toggle("with-panel", !find("#panel").hidden);
  const others = ["compare", "editor", "panel"].filter((other) => other !== name && (matchMedia(NARROW).matches || ![name, other].includes("panel")));
  if (open) for (const other of others) if (!find(`#${other}`).hidden) unfold(other, false);
  window.umbrage.editor?.shown();
}

/** A case of the failure catalogue: what fails as the picture, what survives beside it. */
function open({ state, patch, words, note }) {
  close();
  store.replace(state);
  return compare((made) => {
    unfold("compare", true);
    made.beside(patch, words, note);
  });
}

/** A preset of a scene becomes the state; another scene brings its own controls. */
async function choose(name, preset) {
  try {
    const scene = name === store.scene.name ? store.scene : await api.scene(name);
    const wanted = structuredClone(scene.presets[preset]?.document ?? scene.defaults);
    if (scene !== store.scene) {
      store.schema = schemaOf(scene);
      store.replace(wanted);
      store.describe(scene);
    } else store.replace(wanted);
  } catch (error) {
    notices.toast(error.message, "refusal");
  }
}

async function opened({ detail: welcome }) {
  const { limits = {}, gl = {} } = welcome;
  screen.grey(false);
  waiting();
  if (!store.scene || store.scene.name !== welcome.scene) {
    const scene = await api.scene(welcome.scene);
    store.schema = schemaOf(scene);
    store.adopt(welcome.state);
    store.describe(scene);
    store.announce("scene");
  } else if (!link.pending) store.adopt(welcome.state);
  screen.limit(limits.max_side ?? Infinity, limits.max_side ?? Infinity, gl.software);
  link.pump();
}

/** Words until the first picture; none once there is one. */
function waiting() {
  notices.connection(stats.frames ? null : "Drawing the first picture …");
}

function message({ detail }) {
  if (detail.type === "progress") {
    notices.connection(null);
    notices.working(detail);
  } else if (detail.type === "ready") {
    notices.working(null);
    waiting();
  }
  else if (detail.type === "idle") stats.told = true;
  else if (detail.type === "error") refused(detail);
}

/** A refusal is told at the control that caused it; where none shows it, in a line of its own. */
function refused(error) {
  notices.working(null);
  if (!store.document && opening.state) {
    opening = { ...opening, state: null };
    notices.toast("The link's state was refused, so the scene starts at its defaults.", "refusal");
  }
  const { field, ...rest } = error;
  const sentence = api.sentence({ ...rest, field: "" });
  if (!field || !(window.umbrage.editor?.fail(field, sentence) || panels.fail(field, sentence))) notices.refuse(error);
}

/** A link to another state was pasted into this page's address. */
async function pasted() {
  try {
    const state = await decode(location.hash);
    if (state && store.document) store.replace(state);
  } catch {
    notices.toast("This link is damaged: the picture stays as it was.", "refusal");
  }
}

let stale = false;
const refresh = perFrame(() => {
  if (!store.document || !store.scene) return;
  panels.refresh(stale);
  sunBar.refresh(stale);
  stale = false;
  tools.undo.disabled = !store.past.length;
  tools.redo.disabled = !store.future.length;
});

/** Controls follow the document; seldom during a drag. */
let later = null;
function follow() {
  if (!pointer.pointers.size) refresh();
  else later ??= setTimeout(() => { later = null; refresh(); }, DRAGGED_MS);
}

const KEYS = { KeyH: () => document.body.classList.toggle("bare"), Slash: () => tools.help.click() };

addEventListener("keydown", (event) => {
  const command = event.ctrlKey || event.metaKey;
  const typing = /^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName) && !["range", "radio", "checkbox"].includes(event.target.type);
  if (typing || dialog.open) return;
  if (command && event.code === "KeyZ") {
    event.preventDefault();
    if (event.shiftKey) store.redo();
    else store.undo();
  } else if (!command && !event.altKey) KEYS[event.code]?.();
});

function assemble() {
  const rule = () => el("hr", { "aria-hidden": "true" });
  find("#tools").append(tools.undo, tools.redo, rule(), tools.compare, tools.editor, tools.study, tools.sunlight, tools.open, rule(), tools.share, tools.export, tools.code, rule(), tools.theme, tools.help, tools.panel);
  const closing = (name) => iconButton("close", "Close", () => { unfold(name, false); tools[name].focus(); });
  for (const name of ["panel", "compare", "editor"]) find(`#${name} .panel-head`).append(closing(name));
  dialog.querySelector(".panel-head").append(iconButton("close", "Close", close));
  dialog.addEventListener("click", (event) => event.target === dialog && close());
  find("#time-zones").append(...(Intl.supportedValuesOf?.("timeZone") ?? []).map((value) => el("option", { value })));
  unfold("panel", !matchMedia(NARROW).matches);
  tools.undo.disabled = tools.redo.disabled = true;
}

async function start() {
  theme.start();
  assemble();
  store.addEventListener("change", ({ detail }) => {
    stale ||= detail.source === "server" || detail.source === "scene";
    follow();
  });
  stats.addEventListener("frame", () => {
    waiting();
    runner(() => {});
    panels.drawn = true;
    panels.learn();
  }, { once: true });
  store.addEventListener("scene", () => {
    tools.editor.hidden = !store.schema.at("extrusion", store.document);
    tools.sunlight.hidden = !store.schema.at("terrain", store.document);
  });
  pointer.addEventListener("pick", ({ detail }) => probe((made) => made.ask(detail)));
  screen.addEventListener("size", () => link.send({ type: "resize", width: screen.width, height: screen.height }));
  link.addEventListener("open", (event) => opened(event).catch((error) => notices.toast(error.message, "refusal")));
  link.addEventListener("message", message);
  link.addEventListener("lost", ({ detail }) => {
    screen.grey(true);
    notices.working(null);
    notices.connection(detail.reason || "The connection is lost. Your view is kept; trying again.", true);
  });
  addEventListener("online", () => link.retry());
  addEventListener("hashchange", pasted);
  notices.connection("Connecting to the server …");
  const query = new URLSearchParams(location.search);
  const state = await decode(location.hash).catch(() => notices.toast("This link is damaged, so the scene starts at its defaults.", "refusal"));
  opening = { state: state ?? null, scene: query.get("scene"), preset: query.get("preset") };
  link.connect();
  gallery.load().catch(() => null);
}

window.umbrage = { stats, store, link, screen, encode: () => share.link() };
start();
