// What is done with a sentence: it is read while it is typed, and planned when it is said.

import { carryOut } from "../prediction/approval.js";
import { tellProblem } from "../problems.js";
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
  try {
    const read = await api.parse(text);
    if (state.get("text") === text) state.set({ understanding: withBeginning(state, read) });
  } catch (problem) {
    tellProblem(state, problem);
  }
}

// Reads the sentence of a run, by the names of its own table; what it meant at the time may be unknown.
export async function readAgain(state, api, { run_id: id, text, scene, seed }) {
  clearTimeout(waiting);
  if (!text || !scene) return;
  const read = await api.parse(text, { scene, seed }).catch(() => null);
  if (read?.ok && state.get("run")?.run_id === id && state.get("text") === text) state.set({ understanding: read });
}

// A reading; of a text that may only lack its end, with what was understood of its beginning.
function withBeginning(state, read) {
  const before = state.get("understanding");
  if (read.ok || read.error.span?.[1] !== [...read.text].length) return read;
  const goesOn = before && read.text.startsWith(before.text.trimEnd());
  return { ...read, unfinished: true, explanation: goesOn ? before.explanation : [] };
}

// Says a sentence: it is planned or answered, and done at once if that was chosen.
export async function saySentence(state, api, text) {
  const isDone = state.get("mode") === "at_once";
  await planSentence(state, api, text);
  if (isDone && state.get("offer")?.plan_id && state.get("said") === text) await carryOut(state, api);
}

// Plans a sentence, or answers a question; nothing moves. Without a session it waits for one.
export async function planSentence(state, api, text) {
  if (!text) return;
  clearTimeout(waiting);
  const [read, session] = [state.get("understanding"), state.get("session")];
  state.begin({ text, said: text, understanding: read?.text === text ? read : null, asking: Boolean(session) });
  if (!session) return;
  try {
    const offer = await api.plan(text);
    if (state.get("said") !== text || !state.get("asking")) return; // another one was said meanwhile
    const { result } = offer;
    if (state.isAsShown) state.set({ understanding: understandingOf(result) });
    state.set({ asking: false, ...(result.answer && !result.plan ? { answer: result } : { offer }) });
  } catch (problem) {
    if (isGivenUp(problem)) return;
    state.set({ asking: false });
    tellProblem(state, problem);
  }
}

function understandingOf({ status, text, frames, paraphrase, left_out, error, explanation }) {
  return { ok: !error, status, text, frames, paraphrase, left_out, error, explanation: explanation ?? [] };
}
