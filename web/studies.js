// What the study found: cases in which techniques fail, to open; charts and tables. Fetched when first wanted.

import * as api from "./api.js";
import { el, humanise } from "./dom.js";

const STEP_MS = 120;
const SYMPTOMS = {
  flicker: "Flicker", sway: "Sway of the brightness", error: "Error", stains: "Pixels off by half of the mean",
};
/** Symptoms of pictures have a name; others are said in words. */
const nameOf = (symptom) => SYMPTOMS[symptom] ?? symptom.charAt(0).toUpperCase() + symptom.slice(1);
const percent = (value) => `${Number((100 * value).toPrecision(2))}\u00a0%`;
const quiet = (...children) => el("p", { class: "hint-facts" }, children);

/** Rows and cells of the first table in a Markdown text, its heads first. */
export function tableIn(text) {
  const lines = text.split("\n").filter((line) => line.startsWith("|") && !/^[|\s:-]+$/.test(line));
  return lines.map((line) => line.slice(1, -1).split("|").map((cell) => cell.trim().replaceAll("**", "")));
}

/** The dialog, made once a scene; `open` shows a case as the picture. */
export class Studies {
  constructor(store, open) {
    Object.assign(this, { store, open });
    document.head.append(el("link", { rel: "stylesheet", href: "studies.css" }));
  }

  async fill(root) {
    const { name } = this.store.scene;
    root.replaceChildren(el("p", { role: "status", text: "Asking the server …" }));
    const [cases, files] = await Promise.all([api.study(name, "failures"), api.study(name)]).catch((error) => [error.message]);
    if (!files) root.replaceChildren(el("p", { class: "field-error", text: cases }));
    else root.replaceChildren(...this.failures(cases), ...this.charts(files));
  }

  failures(cases) {
    if (!cases.length) return [];
    return [el("h3", { text: "Where techniques fail, and what survives there" }),
      el("div", { class: "cases" }, cases.map((found) => this.card(found)))];
  }

  card(found) {
    const { title, symptom, threshold, cause, picture, words, state } = found;
    const values = numbers(found);
    const top = Math.max(...values, threshold) * 1.05;
    const share = (value) => `${(100 * value) / top}%`;
    const bar = (value, text) => [el("span", { class: "case-row" }, el("span", { text }), el("span", { text: percent(value) })),
      el("span", { class: "case-bar", data: { fails: value > threshold }, style: { backgroundSize: `2px, ${share(value)}`, backgroundPosition: `${share(threshold)} 0, 0 0` } })];
    // What is a number and no picture has no state to open: its card is its chart.
    const [tag, attributes] = state ? ["button", { type: "button", on: { click: () => this.show(found) } }] : ["article", {}];
    const image = picture && el("img", { src: picture.slice(1), alt: state ? "" : `Chart: ${title}`, loading: "lazy" });
    return el(tag, { class: "case", ...attributes },
      image && (state ? image : el("a", { href: picture.slice(1), target: "_blank", rel: "noopener" }, image)),
      el("strong", { text: title }),
      ...values.flatMap((value, i) => bar(value, words[i])),
      quiet(`${nameOf(symptom)}${found.sweep ? ` while the ${humanise(found.sweep).toLowerCase()} moves` : ""}; above ${percent(threshold)} it is a failure. `, cause));
  }

  /** The case's own state, what fails as A, what survives as B. */
  show(found) {
    const { title, cause, moves, state, patch, words, threshold, symptom } = found;
    const [failing, surviving] = numbers(found).map(percent);
    const note = [el("h3", { text: title }), el("p", { text: cause }),
      quiet(`${nameOf(symptom)}: ${failing} for A, ${surviving} for B; above ${percent(threshold)} it is a failure.`),
      moves.length ? el("button", { type: "button", class: "wide", text: "Play the sweep", on: { click: () => this.play(found) } }) : ""];
    this.open({ state, patch, words, note });
  }

  /** Through the sweep and back; whoever changes something else meanwhile ends it. */
  play({ state, moves }) {
    clearInterval(this.playing);
    const places = [...moves, ...moves.slice(0, -1).reverse(), Object.fromEntries(Object.keys(moves[0]).map((name) => [name, state[name]]))];
    let turn = 0;
    this.playing = setInterval(() => {
      this.store.change(places[turn], "case");
      turn += 1;
      if (turn === places.length) clearInterval(this.playing);
    }, STEP_MS);
  }

  charts(files) {
    const charts = files.filter(({ name }) => name.endsWith(".svg"));
    const tables = files.filter(({ name }) => name.endsWith(".md"));
    if (!charts.length && !tables.length) return [];
    const chart = ({ name, url }) => el("figure", {}, el("figcaption", { text: titleOf(name) }),
      el("a", { href: url.slice(1), target: "_blank", rel: "noopener" }, el("img", { class: "chart", src: url.slice(1), loading: "lazy", alt: `Chart: ${titleOf(name)}` })));
    return [el("h3", { text: "Charts and tables" }), ...charts.map(chart), ...tables.map((file) => this.table(file))];
  }

  /** A table that is read when it is unfolded. */
  table({ name, url }) {
    const body = el("div", { class: "table", tabindex: 0, role: "region", "aria-label": titleOf(name) });
    const read = async () => {
      if (body.children.length) return;
      const text = await api.text(url.slice(1)).catch((error) => error.message);
      const [heads = [], ...rows] = tableIn(text);
      body.replaceChildren(quiet(text.split("\n")[0]), el("table", {}, el("thead", {}, el("tr", {}, heads.map((head) => el("th", { scope: "col", text: head })))),
        el("tbody", {}, rows.map((row) => el("tr", {}, row.map((cell) => el("td", { text: cell })))))));
    };
    return el("details", { class: "fold", on: { toggle: read } }, el("summary", {}, el("h3", { text: `Table: ${titleOf(name)}` })), body);
  }
}

/** What was measured last, or when the case was written: of what fails, of what survives. */
const numbers = ({ failing_now: failing, surviving_now: surviving, measured }) => (failing === null ? measured : [failing, surviving]);

const TITLES = { table: "combined", speed_accuracy: "speed against accuracy" };

/** `stability/flicker.svg` in words. */
function titleOf(path) {
  const [stem, ...folders] = path.replace(/\.\w+$/, "").split("/").reverse();
  return [...folders.reverse(), stem === "table" && folders.length ? null : TITLES[stem] ?? humanise(stem).toLowerCase()].filter(Boolean).join(", ");
}
