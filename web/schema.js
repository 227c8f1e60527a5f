// Reading the JSON schema of a scene's state: the one place that knows pydantic's form of it.

/** Items of a list that people edit one by one; longer ones are painted. */
const LONGEST_LIST = 64;

/** The schema of one scene, with its references resolved on demand. */
export class Schema {
  constructor(root) {
    this.root = root;
    this.definitions = root.$defs ?? {};
  }

  /** The node with its `$ref` followed; its own title, default and extras win. */
  resolve(node) {
    const single = node.allOf?.length === 1 ? node.allOf[0].$ref : undefined;
    const reference = node.$ref ?? single;
    if (!reference) return node;
    const target = this.resolve(this.definitions[reference.split("/").pop()]);
    const { $ref, allOf, ...own } = node;
    return { ...target, ...own };
  }

  /** `[name, node]` of an object's fields, without its discriminator. */
  fields(node) {
    return Object.entries(this.resolve(node).properties ?? {})
      .filter(([name]) => name !== "kind")
      .map(([name, field]) => [name, this.resolve(field)]);
  }

  /** What sort of control a node needs. */
  sort(node) {
    if (node.discriminator || node.oneOf) return "union";
    if (node.properties) return "object";
    if (node.const !== undefined) return "constant";
    if (node.enum) return "choice";
    if (node.type === "boolean") return "switch";
    if (node.type === "number" || node.type === "integer") return "number";
    if (node.type === "array" && node.items && node.maxItems <= LONGEST_LIST) return this.resolve(node.items).properties || node.items.oneOf ? "list" : "other";
    if (node.type === "array" && node.prefixItems) return this.isColour(node) ? "colour" : "vector";
    if (node.type === "string") return "text";
    return "other";
  }

  /** Three linear reflectances in [0, 1] are a colour. */
  isColour(node) {
    const items = node.prefixItems.map((item) => this.resolve(item));
    return items.length === 3 && items.every((item) => item.minimum === 0 && item.maximum === 1);
  }

  /** The members of a discriminated union, by kind. */
  members(node) {
    const list = (node.oneOf ?? node.anyOf ?? []).map((item) => this.resolve(item));
    return new Map(list.map((item) => [item.properties?.kind?.const, item]));
  }

  /** The document of a union's member at its defaults. */
  fresh(member) {
    const document = { kind: member.properties.kind.const };
    for (const [name, field] of this.fields(member)) document[name] = structuredClone(this.defaultOf(field));
    return document;
  }

  /** The default of a field; an object without one of its own has its fields' defaults. */
  defaultOf(node) {
    const member = this.sort(node) === "union" && this.members(node).get(node.default?.kind);
    if (member) return { ...this.fresh(member), ...node.default };
    if (node.default !== undefined) return node.default;
    if (node.const !== undefined) return node.const;
    if (this.sort(node) !== "object") return "";
    return Object.fromEntries(this.fields(node).map(([name, field]) => [name, this.defaultOf(field)]));
  }

  /** A text field that names an uploaded file. */
  isAsset(node) {
    return node.type === "string" && /asset:/.test(node.pattern ?? "");
  }

  /** Whether a union's member is nothing without a file that the person has yet to bring. */
  needsFile(member) {
    return this.fields(member).some(([, field]) => this.isAsset(field) && field.default === undefined);
  }

  /** The node at a dotted path of a document, through the union members that the document chose. */
  at(path, document) {
    let node = this.resolve(this.root);
    let here = document;
    for (const key of path.split(".")) {
      if (this.sort(node) === "list") {
        [node, here] = [this.resolve(node.items), here?.[key]];
        continue;
      }
      if (this.sort(node) === "union") node = this.members(node).get(here?.kind);
      node = node?.properties?.[key] && this.resolve(node.properties[key]);
      here = here?.[key];
      if (!node) return null;
    }
    return node;
  }

  /** A number brought into the range of the field at `path`. */
  clamp(path, document, value) {
    const node = this.at(path, document) ?? {};
    const { minimum = -Infinity, maximum = Infinity } = range(node);
    return Math.min(maximum, Math.max(minimum, value));
  }
}

/** Both ends of a number's range; an open end counts as closed just inside. */
export function range(node) {
  const { minimum, maximum, exclusiveMinimum: above, exclusiveMaximum: below } = node;
  const nudge = (value) => Math.max(Math.abs(value), 1) * 1e-6;
  return {
    minimum: minimum ?? (above === undefined ? undefined : above + nudge(above)),
    maximum: maximum ?? (below === undefined ? undefined : below - nudge(below)),
  };
}

const UNITS = { deg: "°", um: "µm", "m-1": "m⁻¹", "m s-1": "m s⁻¹", ratio: "", count: "", date: "", "W m-2": "W m⁻²" };

/** A unit as people read it. */
export function unitOf(node) {
  const unit = node.umbrage?.unit ?? "";
  return UNITS[unit] ?? unit;
}

/** A sensible step: the declared one, 1 for integers, else a thousandth of the range. */
export function stepOf(node) {
  if (node.umbrage?.step) return node.umbrage.step;
  if (node.type === "integer") return 1;
  const { minimum, maximum } = range(node);
  const span = maximum !== undefined && minimum !== undefined ? maximum - minimum : Math.max(1, Math.abs(node.default ?? 1));
  return 10 ** Math.floor(Math.log10(span / 300));
}
