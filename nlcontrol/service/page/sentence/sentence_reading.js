// What is done with a sentence: read while it is typed, planned or done when it is said.

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

// Says a sentence: it is planned, or done at once if the mode says so; a question is answered.
export async function saySentence(state, api, text) {
  if (!text || !state.get("session")) return;
  clearTimeout(waiting);
  if (state.get("mode") === "at_once") await doSentence(state, api, text);
  else await planSentence(state, api, text);
}

// Plans a sentence; nothing moves.
export async function planSentence(state, api, text) {
  state.set({ text, offer: null, answer: null, result: null, problem: null, asking: true });
  await told(state, async () => {
    const offer = await api.plan(text);
    const { result } = offer;
    state.set({ understanding: understandingOf(result) });
    state.set(result.answer && !result.plan ? { answer: result } : { offer });
  });
  state.set({ asking: false });
}

async function doSentence(state, api, text) {
  state.set({ text, offer: null, answer: null, result: null, problem: null, asking: true });
  await told(state, async () => {
    const understanding = await api.parse(text);
    state.set({ understanding });
    if (!understanding.ok || understanding.frames.every((frame) => frame.query)) {
      await planSentence(state, api, text);
    } else {
      state.set({ events: [], run: await api.say(text) });
    }
  });
  state.set({ asking: false });
}

function understandingOf({ text, frames, paraphrase, error, explanation }) {
  return { ok: !error, text, frames, paraphrase, error, explanation: explanation ?? [] };
}

async function told(state, call) {
  try {
    await call();
  } catch (problem) {
    if (!isGivenUp(problem)) state.set({ problem });
  }
}
