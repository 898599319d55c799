// What is foreseen before anything moves, or why nothing will.

import { element, section } from "../elements.js";
import { carryOut, isUnderWay, planAgain } from "./approval.js";
import { faceMap } from "./face_map.js";
import { sketchOffers } from "./offer_sketch.js";
import { share } from "./quantities.js";

const VERBS = { slide: "It slides", topple: "It topples", none: "It stays" };
const ENDS = { turned: "It turns", tilted: "It tilts and stands again", toppled: "It topples" };

export function predictionPanel(state, api, view) {
  const panel = section("Prediction", { id: "prediction", hidden: true });
  const heading = panel.firstChild;
  const approve = element("button", { type: "button", class: "primary", id: "do-it" });
  let expiry = null;
  const offerAgain = (fresh) => {
    approve.textContent = fresh ? "Do it" : "Plan again";
    approve.onclick = () => (fresh ? carryOut(state, api) : planAgain(state, api));
  };
  const tell = () => {
    const offer = state.get("offer");
    clearTimeout(expiry);
    panel.hidden = !offer?.drawing && offer?.result.status !== "refused";
    if (panel.hidden) return;
    const { result, drawing } = offer;
    const plan = result.steps.at(-1)?.plan;
    offerAgain(true);
    if (offer.expires_in) expiry = setTimeout(() => offerAgain(false), 1e3 * offer.expires_in);
    panel.replaceChildren(heading, ...(plan
      ? planned(offer, plan, approve, mapOf(state, api, drawing, plan))
      : refused(result, drawing)));
    if (offer.plan_id && state.get("mode") === "at_once") carryOut(state, api);
  };
  state.on(["offer"], tell);
  state.on(["offer", "run"], () => {
    approve.hidden = !state.get("offer")?.plan_id || isUnderWay(state.get("run")) || Boolean(state.get("result"));
  });
  state.on(["problem"], () => {
    if (STALE.has(state.get("problem")?.code)) offerAgain(false);
  });
  sketchOffers(state, view);
  return panel;
}

const STALE = new Set(["stale_plan", "expired_plan", "unknown_plan", "used_plan"]);

function mapOf(state, api, drawing, plan) {
  const object = state.get("table")?.objects.find(({ name }) => name === drawing.object);
  const push = plan.actions.find(({ kind }) => kind === "push");
  return push && object ? faceMap(api, drawing, push, object.size) : null;
}

function* planned({ result, drawing }, plan, approve, map) {
  const [first] = plan.actions;
  const verb = ENDS[first.ends_on] ?? VERBS[first.prediction?.outcome] ?? `To ${plan.task} it`;
  yield element("p", { class: "headline", role: "status" },
    element("b", {}, `${verb}: `), `probability ${share(plan.probability)}`);
  yield approve;
  if (map) yield map;
  for (const { heading, text } of drawing.lines) {
    yield element("p", {}, heading ? element("b", {}, `${heading} `) : null, text);
  }
  for (const note of result.notes) yield element("p", { class: "asked" }, note);
}

function* refused({ status, error }, drawing) {
  yield element("p", { class: "headline", role: "status" },
    element("span", { class: "badge" }, status.replaceAll("_", " ")));
  const { message } = error;
  yield element("p", {}, message.charAt(0).toUpperCase() + message.slice(1), ".");
  const marks = drawing?.marks ?? [];
  if (marks.length) {
    yield element("ul", { class: "marks" }, ...marks.map((mark) =>
      element("li", { "data-about": mark.about ?? mark.kind }, mark.text)));
  }
}
