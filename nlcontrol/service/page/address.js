// The address of what the page shows: sentence, scene, seed, and the run if there is one. A reload and
// Back lead there again, and so does a link that somebody else opens; none of them moves anything.

import { isUnderWay } from "./app_state.js";
import { takeUpSession } from "./open_session.js";
import { tellProblem } from "./problems.js";
import { showRun } from "./run/show_run.js";

const GONE = "The run at this address is no longer stored.";

export function addressOf({ text, scene, seed, run }) {
  const link = new URL(location.pathname, location.origin);
  const told = { say: text, scene, seed, run };
  for (const [key, value] of Object.entries(told)) {
    if (value || value === 0) link.searchParams.set(key, String(value));
  }
  return link.href;
}

// What an address asks for.
function asked() {
  const { say = "", scene, seed, run } = Object.fromEntries(new URLSearchParams(location.search));
  return { say, scene, seed: seed === undefined ? seed : Number(seed), run };
}

function shownAddress(state) {
  const run = state.get("run");
  return addressOf({
    text: run?.text ?? state.get("said"),
    scene: run?.scene ?? state.get("scene"),
    seed: run?.seed ?? state.get("seed"),
    run: run?.run_id,
  });
}

// Shows what the address asks for, now and on Back, and keeps the address with what is shown.
export async function followAddress(state, api) {
  let followed = null; // sentence of the address, while the page is on its way there
  const follow = async () => {
    const { say, scene, seed, run } = asked();
    followed = state.get("said");
    try {
      await begin(state, api, say, run);
      followed = state.get("said");
      await takeUpSession(state, api, { scene, seed });
    } finally {
      followed = null;
    }
    history.replaceState(null, "", shownAddress(state));
    if (run && !state.get("run") && state.get("said") === say) state.set({ problem: { detail: GONE } });
  };
  const keep = () => {
    const address = shownAddress(state);
    if (state.get("said") === followed || !state.get("session") || address === location.href) return;
    history.pushState(null, "", address);
  };
  state.on(["said", "session", "run"], () => queueMicrotask(keep)); // once all of a change is there
  addEventListener("popstate", () => {
    // What is carried out stays in sight, with its Stop.
    if (isUnderWay(state.get("run"))) history.pushState(null, "", shownAddress(state));
    else follow().catch((problem) => tellProblem(state, problem));
  });
  await follow();
}

// Begins with the run of an address, or with its sentence.
async function begin(state, api, say, id) {
  try {
    if (id) return showRun(state, api, await api.run(id));
  } catch (problem) {
    if (problem.code !== "unknown_run") throw problem;
  }
  state.begin({ text: say, said: say });
}
