// Keeps the page going: waits for a service that does not answer, and opens another session when the
// last one is lost. Nothing moves by that: what was planned is planned again, and waits for approval.

import { element } from "./elements.js";
import { leaveSession, offerCutOff, openAgain } from "./open_session.js";
import { tellProblem } from "./problems.js";
import { settleRun } from "./run/follow_run.js";

const FIRST_PAUSE = 500; // before the service is asked again; each is twice the last [ms]
const LONGEST_PAUSE = 30_000; // [ms]

const TOLD = {
  no_answer: ["The service does not answer. The page keeps trying.", "Try now"],
  full: ["All sessions of this service are in use. History still works.", "Try again"],
};

// The banner of the connection, and what mends it.
export function sessionKeeper(state, api) {
  const mend = mending(state, api);
  const text = element("span");
  const again = element("button", { type: "button", onclick: mend });
  const banner = element("div", { id: "banner", role: "alert", hidden: true }, text, again);
  state.on(["connection"], () => {
    const [told, button] = TOLD[state.get("connection")] ?? [];
    banner.hidden = !told;
    text.textContent = told ?? "";
    again.textContent = button ?? "";
  });
  api.onGap = () => api.health().catch((problem) => tellProblem(state, problem));
  addEventListener("pagehide", () => api.giveBack());
  addEventListener("pageshow", ({ persisted }) => {
    if (!persisted) return;
    leaveSession(api); // it was given back when the page was left
    mend();
  });
  return banner;
}

function mending(state, api) {
  const isBroken = () => ["no_answer", "no_session"].includes(state.get("connection"));
  let pause = FIRST_PAUSE;
  let waiting;
  let isMending = false;
  const mend = async () => {
    if (isMending) return;
    isMending = true;
    clearTimeout(waiting);
    try {
      await api.health();
      state.set({ connection: "open" });
      if (!state.get("ready")) location.reload(); // it had not even begun
      await settleRun(state, api);
      await openAgain(state, api);
      await offerCutOff(state, api);
      pause = FIRST_PAUSE;
    } catch (problem) {
      if (problem.code === "wrong_token") location.reload(); // which asks for it
      tellProblem(state, problem);
    }
    isMending = false;
    if (!isBroken()) return;
    waiting = setTimeout(mend, pause);
    pause = Math.min(2 * pause, LONGEST_PAUSE);
  };
  state.on(["connection"], () => isBroken() && mend());
  return mend;
}
