// What is approved is done: the plan of the offer, exactly that one.

import { isGivenUp } from "../service_api.js";

// Begins to carry out the plan that is offered.
export async function carryOut(state, api) {
  const { plan_id: planId } = state.get("offer") ?? {};
  if (!planId) return;
  try {
    state.set({ problem: null });
    state.set({ run: await api.execute(planId), events: [], result: null });
  } catch (problem) {
    if (!isGivenUp(problem)) state.set({ problem });
  }
}

// Plans the same sentence from how everything stands now.
export async function planAgain(state, api) {
  const { text } = state.get("offer").result;
  try {
    state.set({ problem: null, offer: await api.plan(text) });
  } catch (problem) {
    if (!isGivenUp(problem)) state.set({ problem });
  }
}

// True while something is carried out, or waits for its turn.
export function isUnderWay(run) {
  return run?.state === "queued" || run?.state === "running";
}
