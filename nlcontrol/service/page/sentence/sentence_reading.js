// What is done with a sentence: it is read while it is typed, and planned when it is said.

import { isGivenUp } from "../service_api.js";

const PAUSE = 120; // of the keys, after which the text is read [ms]

let waiting;

// Takes what stands in the field, and reads it after a pause.
export function typeText(state, api, text) {
  clearTimeout(waiting);
  state.set({ text });
  if (!text.trim()) {
    state.set({ understanding: null });
    return;
  }
  waiting = setTimeout(() => readText(state, api, text), PAUSE);
}

async function readText(state, api, text) {
  if (!state.get("session")) return;
  await told(state, async () => {
    const read = await api.parse(text);
    if (state.get("text") === text) state.set({ understanding: withBeginning(state, read) });
  });
}

// A reading; of a text that may only lack its end, with what was understood of its beginning.
function withBeginning(state, read) {
  const before = state.get("understanding");
  if (read.ok || read.error.span?.[1] !== [...read.text].length) return read;
  const goesOn = before && read.text.startsWith(before.text.trimEnd());
  return { ...read, unfinished: true, explanation: goesOn ? before.explanation : [] };
}

// Plans a sentence, or answers a question; nothing moves.
export async function saySentence(state, api, text) {
  if (!text || !state.get("session")) return;
  clearTimeout(waiting);
  state.set({ text, offer: null, answer: null, result: null, problem: null, asking: true });
  await told(state, async () => {
    const offer = await api.plan(text);
    const { result } = offer;
    state.set({ understanding: understandingOf(result) });
    state.set(result.answer && !result.plan ? { answer: result } : { offer });
  });
  state.set({ asking: false });
}

function understandingOf({ status, text, frames, paraphrase, left_out, error, explanation }) {
  return { ok: !error, status, text, frames, paraphrase, left_out, error, explanation: explanation ?? [] };
}

async function told(state, call) {
  try {
    await call();
  } catch (problem) {
    if (!isGivenUp(problem)) state.set({ problem });
  }
}
