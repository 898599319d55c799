// What the page knows; its parts read it, change it, and hear of changes.

const FIRST = {
  scenes: [], // that may be asked for, `{name, objects}` each
  objects: [], // models of the host, in a few figures each
  scene: "kitchen",
  seed: 0,
  session: null, // SessionInfo
  table: null, // TableView
  text: "", // that stands in the field
  understanding: null, // of that text: answer of parse
  offer: null, // Offer; a refusal is one too, by the status of its result
  answer: null, // Result of a question
  run: null, // RunInfo
  events: [], // of the run, NumberedEvent each
  pose: null, // last live frame
  asking: false, // true while a sentence is planned
  result: null, // Result of the run that has ended
  mode: "approve", // or "at_once"
  problem: null, // the last problem document
};

export class AppState extends EventTarget {
  #values = { ...FIRST };

  get(key) {
    return this.#values[key];
  }

  // Changes some values, and tells their keys in `detail.keys` of a `change`.
  set(values) {
    const keys = Object.keys(values).filter((key) => this.#values[key] !== values[key]);
    Object.assign(this.#values, values);
    if (keys.length) this.dispatchEvent(new CustomEvent("change", { detail: { keys } }));
  }

  // Calls `listener` now, and whenever one of the keys changes.
  on(keys, listener) {
    this.addEventListener("change", ({ detail }) => {
      if (detail.keys.some((key) => keys.includes(key))) listener(this);
    });
    listener(this);
  }
}
