// The REST doors the page uses; every refusal becomes an error whose message is a sentence.

/** What the server said no to: `errors` are `{field, message, allowed}`. */
export class Refused extends Error {
  constructor(errors) {
    super(errors.map(sentence).join(" "));
    this.errors = errors;
  }
}

/** One refusal in words. */
export function sentence({ field, message, allowed }) {
  const start = [field, message].filter(Boolean).join(": ");
  return `${start}${allowed ? ` (allowed: ${allowed})` : ""}.`.replace(/\.\.$/, ".");
}

async function refusal(answer) {
  const body = await answer.json().catch(() => null);
  return new Refused(body?.errors ?? [{ field: "", message: `The server answered ${answer.status}`, allowed: "" }]);
}

async function request(path, options = {}) {
  let answer;
  try {
    answer = await fetch(path, options);
  } catch {
    throw new Refused([{ field: "", message: "The server cannot be reached", allowed: "" }]);
  }
  if (!answer.ok) throw await refusal(answer);
  return answer;
}

const asJson = (body) => ({ method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });

export const scenes = async () => (await request("api/scenes")).json();
export const scene = async (name) => (await request(`api/scenes/${encodeURIComponent(name)}`)).json();
export const study = async (name, what = "") => (await request(`api/study/${encodeURIComponent(name)}${what && `/${what}`}`)).json();
export const text = async (address) => (await request(address)).text();
export const quantities = async () => (await request("api/measure")).json();
export const measureSun = async (moment) => (await request("api/measure/sun", asJson(moment))).json();

/** Seconds of precomputation that a state with other values would take. */
export const cost = async (state, sets) => (await request("api/cost", asJson({ state, sets }))).json();

/** What a scene is built of, as lines over its picture. */
export const outline = async (state) => (await request("api/outline", asJson({ state }))).json();

/** A finished picture as a blob of `type`. */
export async function render(state, width, height, type = "image/png") {
  const options = asJson({ scene: state.scene, state, width, height });
  options.headers.Accept = type;
  return (await request("api/render", options)).blob();
}

/** Upload a file, read with what `reading` says that it leaves unsaid; resolves to what the server found in it. */
export async function upload(file, reading = {}) {
  const body = new FormData();
  for (const [name, value] of Object.entries(reading)) body.append(name, typeof value === "string" ? value : JSON.stringify(value));
  body.append("file", file, file.name);
  return (await request("api/assets", { method: "POST", body })).json();
}

const POLL_MS = 400;

/** Start long work and follow it; `signal` aborts both. Resolves to the job's result. */
export async function job(body, onProgress, signal) {
  const { id } = await (await request("api/jobs", asJson(body))).json();
  for (;;) {
    await new Promise((resolve) => setTimeout(resolve, POLL_MS));
    if (signal.aborted) {
      await request(`api/jobs/${id}`, { method: "DELETE" });
      throw new DOMException("Cancelled", "AbortError");
    }
    const state = await (await request(`api/jobs/${id}`)).json();
    if (state.result) return state.result;
    if (["failed", "cancelled"].includes(state.status)) {
      throw new Refused(state.errors ?? [{ field: "", message: state.words, allowed: "" }]);
    }
    onProgress(state);
  }
}
