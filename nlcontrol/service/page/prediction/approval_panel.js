// What will happen, in one line under the table, and the button that lets it happen.

import { element } from "../elements.js";
import { isUnderWay } from "../app_state.js";
import { carryOut, planAgain } from "./approval.js";
import { share } from "./quantities.js";

const OUTCOMES = { slide: "slides", topple: "topples", none: "stays" };
const ENDS = { turned: "turns", tilted: "tilts and stands again", toppled: "topples" };
const STALE = new Set(["stale_plan", "expired_plan", "unknown_plan", "used_plan"]);

export function approvalPanel(state, api) {
  const told = element("p", { role: "status" });
  const changed = element("p", { class: "asked", hidden: true }, "The sentence has changed. Press Plan to plan it.");
  const approve = element("button", { type: "button", class: "primary", id: "do-it" });
  const panel = element("section", { id: "approval", "aria-label": "Approval", hidden: true }, told, changed, approve);
  let expiry = null;
  const offer = (fresh) => {
    approve.textContent = fresh ? "Do it" : "Plan again";
    approve.onclick = () => (fresh ? carryOut(state, api) : planAgain(state, api));
  };
  state.on(["offer"], () => {
    const { result, expires_in: life } = state.get("offer") ?? {};
    clearTimeout(expiry);
    offer(true);
    if (life) expiry = setTimeout(() => offer(false), 1e3 * life);
    told.replaceChildren(...(result ? summary(result) : []));
  });
  state.on(["offer", "run", "result", "text", "said", "connection"], () => {
    const { plan_id: planId, result } = state.get("offer") ?? {};
    const over = isUnderWay(state.get("run")) || Boolean(state.get("result"));
    panel.hidden = !result || over;
    approve.hidden = !planId;
    approve.disabled = !state.isAsShown || state.get("connection") !== "open";
    panel.dataset.stale = String(!state.isAsShown);
    changed.hidden = state.isAsShown;
  });
  state.on(["problem"], () => {
    if (STALE.has(state.get("problem")?.code)) offer(false);
  });
  return panel;
}

// An offer in one line.
function summary({ status, steps, error }) {
  const plan = steps.at(-1)?.plan;
  if (!plan) {
    const badge = element("span", { class: "badge", "data-ok": String(status === "planned") }, status.replaceAll("_", " "));
    return status === "refused" ? [badge, ` ${error.message}`] : [badge];
  }
  const [first] = plan.actions;
  const verb = ENDS[first.ends_on] ?? OUTCOMES[first.prediction?.outcome];
  const task = `${plan.task.charAt(0).toUpperCase()}${plan.task.slice(1)} the ${plan.object}`;
  const what = verb ? `The ${plan.object} ${verb}` : `${task}: success`;
  return [element("b", {}, what), ` with probability ${share(plan.probability)}`];
}
