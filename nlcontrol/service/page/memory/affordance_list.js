// What the robot can bring about with an object, and for the rest, why not.

import { element } from "../elements.js";
import { typeText } from "../sentence/sentence_reading.js";
import { tellProblem } from "../problems.js";

const VERBS = { slide: "push", topple: "topple", tilt: "tilt", turn: "turn" };
const WAYS = { away: "away", toward: "toward me", left: "to the left", right: "to the right" };

// The list, worked out once it is unfolded; what can be done can be taken into the field.
export function affordanceList(state, api, name) {
  const list = element("ul", { class: "affordances" });
  const folded = element("details", {}, element("summary", {}, "What can be done with it"), list);
  folded.addEventListener("toggle", async () => {
    if (!folded.open || list.children.length) return;
    list.append(element("li", { role: "status" }, "Working it out …"));
    try {
      const { affordances } = await api.affordances(name, statedTable(state));
      list.replaceChildren(...affordances.map((each) => item(state, api, name, each)));
    } catch (problem) {
      list.replaceChildren();
      tellProblem(state, problem);
    }
  });
  return folded;
}

// The table as it is believed to stand now: thinking about it keeps the session free.
function statedTable(state) {
  const objects = state.get("table").objects.map(({ name, model, x, y, yaw, fragile, fixed }) =>
    ({ name, model, x, y, yaw, fragile, fixed }));
  return { scene: state.get("scene"), seed: state.get("seed"), objects };
}

function item(state, api, name, { outcome, direction, can, message }) {
  const said = [VERBS[outcome] ?? outcome, `the ${name}`, WAYS[direction]].filter(Boolean).join(" ");
  const sayable = can && outcome !== "pour";
  const take = () => {
    typeText(state, api, said);
    document.getElementById("say").focus();
  };
  return element("li", { "data-ok": String(can) },
    element("span", { class: "mark", role: "img", "aria-label": can ? "possible" : "not possible" }, can ? "✓" : "✗"),
    element("div", {},
      sayable ? element("button", { type: "button", class: "run", onclick: take }, said) : element("b", {}, said),
      element("span", { class: "asked" }, message)));
}
