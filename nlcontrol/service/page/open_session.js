// Sessions of the page: one for each tab, which a reload finds again.

import { tellProblem } from "./problems.js";
import { planSentence } from "./sentence/sentence_reading.js";

const KEY = "nlcontrol session";
const NEW_SESSION = "The session had ended. A new one has begun, with the table as at the start.";

// Takes up the session of this tab if its table is the one that is wanted; else opens one.
export async function takeUpSession(state, api, { scene, seed }) {
  const session = await knownSession(api);
  const { spec } = session ?? {};
  const fits = (scene ?? spec?.scene) === spec?.scene && (seed ?? spec?.seed) === spec?.seed;
  if (session && fits) await enter(state, api, session);
  else await changeTable(state, api, scene ?? state.get("scene"), seed ?? state.get("seed"));
}

async function knownSession(api) {
  const id = api.sessionId ?? sessionStorage.getItem(KEY);
  if (!id) return null;
  try {
    const session = await api.session(id);
    return session.state === "lost" ? null : session;
  } catch (problem) {
    if (problem.code !== "unknown_session") throw problem;
    return null;
  }
}

// Opens another table, and leaves the one before with all that was said there.
export async function openSession(state, api, scene, seed) {
  state.begin({ run: null, events: [] });
  await changeTable(state, api, scene, seed);
}

async function changeTable(state, api, scene, seed) {
  const before = state.get("session");
  state.set({ session: null, scene, seed });
  leaveSession(api);
  if (before) api.closeSession(before.session_id).catch(() => {});
  try {
    await enter(state, api, await api.openSession({ scene, seed }));
  } catch (problem) {
    tellProblem(state, problem);
  }
}

// Opens a session for the same table in the place of one that is lost; what was said stays.
export async function openAgain(state, api) {
  const before = state.get("session");
  const known = await knownSession(api);
  if (known) {
    if (known.session_id !== before?.session_id) await enter(state, api, known);
    else planUnplanned(state, api);
    return;
  }
  state.set({ session: null, offer: null, asking: false });
  leaveSession(api);
  const [scene, seed] = [state.get("scene"), state.get("seed")];
  await enter(state, api, await api.openSession({ scene, seed }));
  if (before) state.set({ problem: { detail: NEW_SESSION } });
}

// Plans again what was cut off; the run that was stays to be seen beside the offer.
export async function offerCutOff(state, api) {
  const [run, said] = [state.get("run"), state.get("said")];
  const isOpen = ["offer", "answer", "asking"].every((key) => !state.get(key));
  if (run?.state !== "cut_off" || run.text !== said || !state.isAsShown || !isOpen) return;
  const offer = await api.plan(said);
  if (state.get("run") === run && state.get("said") === said) state.set({ offer });
}

// Says nothing further in a session, also after a reload.
export function leaveSession(api) {
  api.forget();
  sessionStorage.removeItem(KEY);
}

async function enter(state, api, session) {
  api.enter(session);
  sessionStorage.setItem(KEY, session.session_id);
  const { scene, seed, approval } = session.spec;
  const mode = approval === "plan" ? "approve" : state.get("mode");
  const run = !state.get("run") && session.run_id ? await api.run(session.run_id) : null;
  state.set({ session, scene, seed, mode, ...(run ? { run, said: run.text } : {}) });
  if (session.state === "idle") state.set({ table: await api.look() });
  planUnplanned(state, api);
}

// Plans what was said while there was no session, or in one that is lost.
function planUnplanned(state, api) {
  const isOpen = ["offer", "answer", "run", "asking"].every((key) => !state.get(key));
  if (state.get("said") && state.isAsShown && isOpen) planSentence(state, api, state.get("said"));
}
