// What the page knows; its parts read it, change it, and hear of changes.

// Of one sentence, from its plan to its verdict: all of it begins anew with the next one.
const STORY = {
  said: "", // the sentence that was planned, asked, or is carried out
  understanding: null, // of the text in the field: answer of parse
  offer: null, // Offer; a refusal is one too, by the status of its result
  answer: null, // Result of a question
  run: null, // RunInfo
  events: [], // of the run, NumberedEvent each
  result: null, // Result of the run that has ended
  asking: false, // true while a sentence is planned
  problem: null, // the last problem document
};

const FIRST = {
  ...STORY,
  ready: false, // true once the page has shown what its address asks for
  scenes: [], // that may be asked for, `{name, objects}` each
  objects: [], // models of the host, in a few figures each
  scene: "kitchen",
  seed: 0,
  session: null, // SessionInfo
  connection: "open", // or "no_answer", "no_session", "full"; see session_keeper.js
  table: null, // TableView
  text: "", // that stands in the field
  pose: null, // last live frame
  mode: "approve", // or "at_once"
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

  // Begins another sentence, of which this is known; a run that is under way goes on.
  begin(values) {
    const { run, events } = this.#values;
    this.set({ ...STORY, ...(isUnderWay(run) ? { run, events } : {}), ...values });
  }

  // True if the field says what was planned: only then may it be done.
  get isAsShown() {
    return this.#values.text === this.#values.said;
  }

  // Calls `listener` now, and whenever one of the keys changes.
  on(keys, listener) {
    this.addEventListener("change", ({ detail }) => {
      if (detail.keys.some((key) => keys.includes(key))) listener(this);
    });
    listener(this);
  }
}

// True while something is carried out, or waits for its turn.
export function isUnderWay(run) {
  return Boolean(run) && run.ended_at === null;
}
