// What is approved is done: the plan of the offer, exactly that one, under the sentence in the field.

import { tellProblem } from "../problems.js";

// Begins to carry out the plan that is offered, if the field says what was planned.
export async function carryOut(state, api) {
  const { plan_id: planId } = state.get("offer") ?? {};
  if (!planId || !state.isAsShown) return;
  try {
    state.set({ problem: null });
    state.set({ run: await api.execute(planId, state.get("text")), events: [], result: null });
  } catch (problem) {
    tellProblem(state, problem);
  }
}

// Plans the same sentence from how everything stands now.
export async function planAgain(state, api) {
  try {
    state.set({ problem: null, offer: await api.plan(state.get("said")) });
  } catch (problem) {
    tellProblem(state, problem);
  }
}
