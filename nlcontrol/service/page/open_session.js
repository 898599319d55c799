// Sessions of the page: one for each tab, which a reload finds again.

import { isGivenUp } from "./service_api.js";

const KEY = "nlcontrol session";

// Takes up the session of this tab, or opens one for the scene and seed of the state.
export async function takeUpSession(state, api) {
  const known = sessionStorage.getItem(KEY);
  if (known) {
    try {
      const session = await api.session(known);
      if (session.state !== "lost") return await enter(state, api, session);
    } catch (problem) {
      if (problem.code !== "unknown_session") throw problem;
    }
  }
  return openSession(state, api, state.get("scene"), state.get("seed"));
}

// Opens another session, and leaves the one before.
export async function openSession(state, api, scene, seed) {
  const before = state.get("session");
  state.set({ session: null, offer: null, answer: null, run: null, events: [], result: null });
  if (before) api.closeSession(before.session_id).catch(() => {});
  try {
    await enter(state, api, await api.openSession({ scene, seed }));
  } catch (problem) {
    if (!isGivenUp(problem)) state.set({ problem });
  }
}

async function enter(state, api, session) {
  api.sessionId = session.session_id;
  sessionStorage.setItem(KEY, session.session_id);
  const { scene, seed, approval } = session.spec;
  const mode = approval === "plan" ? "approve" : state.get("mode");
  state.set({ session, scene, seed, mode, run: session.run_id ? await api.run(session.run_id) : null });
  if (session.state === "idle") state.set({ table: await api.look() });
}
