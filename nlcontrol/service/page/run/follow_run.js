// The run of the session: its events as they come, and its end.

import { isUnderWay } from "../app_state.js";
import { tellProblem } from "../problems.js";

const ASK_EVERY = 1000; // for the place of a run in the queue [ms]

const SOON = 150; // [ms]

// Follows whatever run stands in the state, from its first event on, also after a reload.
export function followRun(state, api) {
  let followed = null;
  let end = () => {};
  state.on(["run"], () => {
    const run = state.get("run");
    if (run?.run_id === followed) return;
    end();
    end = () => {};
    followed = run?.run_id;
    if (isUnderWay(run)) end = follow(state, api, run.run_id);
  });
}

function follow(state, api, id) {
  const isShown = () => state.get("run")?.run_id === id;
  const told = ({ number, event }) => {
    if (!isShown()) return;
    const run = state.get("run");
    if (run.state === "queued") state.set({ run: { ...run, state: "running", place: null } });
    state.set({ events: [...state.get("events").filter((each) => each.number < number), { number, event }] });
  };
  state.set({ events: [], result: null, text: state.get("text") || state.get("run").text });
  const waiting = setInterval(async () => {
    if (!isShown() || state.get("run").state !== "queued") return;
    const run = await api.run(id).catch(() => null);
    if (run && isShown()) state.set({ run });
  }, ASK_EVERY);
  const close = api.events(id, 0, told, () => {
    clearInterval(waiting);
    if (isShown()) finish(state, api, id);
  });
  return () => {
    clearInterval(waiting);
    close();
  };
}

// Takes what the store says of a run that was under way when the service was lost.
export async function settleRun(state, api) {
  const run = state.get("run");
  if (!isUnderWay(run)) return;
  let now = null;
  try {
    now = await api.run(run.run_id);
  } catch (problem) {
    if (problem.code !== "unknown_run") throw problem;
    now = { ...run, state: "cut_off", ended_at: Date.now() / 1e3 };
  }
  if (state.get("run")?.run_id !== run.run_id) return;
  state.set({ run: null }); // its stream may have ended: it is followed anew
  state.set({ run: now, result: now.result });
}

async function finish(state, api, id) {
  try {
    let run = await api.run(id);
    while (run.ended_at === null) { // its last event is told a little earlier
      await new Promise((done) => setTimeout(done, SOON));
      run = await api.run(id);
    }
    if (state.get("run")?.run_id === id) state.set({ run, result: run.result });
    if (!state.get("session")) return;
    const session = await api.session();
    if (session.state === "lost") throw { code: "session_lost" };
    state.set({ session });
    if (session.state === "idle") state.set({ table: await api.look() });
  } catch (problem) {
    if (problem.code !== "busy") tellProblem(state, problem); // the next run is quicker than the look
  }
}
