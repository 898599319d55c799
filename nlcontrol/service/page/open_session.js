// Sessions of the page: one for each tab, which a reload finds again.

import { isGivenUp } from "./service_api.js";

const KEY = "nlcontrol session";

// Takes up the session of this tab, unless a link asks for another table; else opens one.
export async function takeUpSession(state, api, link) {
  const wanted = { scene: state.get("scene"), seed: state.get("seed"), ...link };
  const session = await knownSession(api);
  const { scene, seed } = session?.spec ?? {};
  const fits = (link.scene ?? scene) === scene && (link.seed ?? seed) === seed;
  if (session && fits) await enter(state, api, session);
  else await openSession(state, api, wanted.scene, wanted.seed);
}

async function knownSession(api) {
  const id = sessionStorage.getItem(KEY);
  if (!id) return null;
  try {
    const session = await api.session(id);
    return session.state === "lost" ? null : session;
  } catch (problem) {
    if (problem.code !== "unknown_session") throw problem;
    return null;
  }
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
  api.enter(session);
  sessionStorage.setItem(KEY, session.session_id);
  const { scene, seed, approval } = session.spec;
  const mode = approval === "plan" ? "approve" : state.get("mode");
  state.set({ session, scene, seed, mode, run: session.run_id ? await api.run(session.run_id) : null });
  if (session.state === "idle") state.set({ table: await api.look() });
}
