// What is foreseen before anything moves, or what stands in its way.

import { element, section } from "../elements.js";
import { faceMap } from "./face_map.js";
import { sketchOffers } from "./offer_sketch.js";

export function predictionPanel(state, api, view) {
  const content = element("div");
  const panel = section("Prediction", { id: "prediction" }, content);
  state.on(["offer"], () => {
    const { result, drawing } = state.get("offer") ?? {};
    const told = drawing ? [mapOf(state, api, drawing, result), ...lines(result, drawing)].filter(Boolean) : [];
    panel.hidden = !told.length;
    content.replaceChildren(...told);
  });
  state.on(["text", "said"], () => {
    panel.dataset.stale = String(!state.isAsShown);
    panel.inert = !state.isAsShown;
  });
  sketchOffers(state, view);
  return panel;
}

function mapOf(state, api, drawing, result) {
  const object = state.get("table")?.objects.find(({ name }) => name === drawing.object);
  const push = result.plan?.actions.find(({ kind }) => kind === "push");
  return push && object ? faceMap(api, drawing, push, object.size) : null;
}

// What is foreseen in words; of a refusal what its marks on the table say.
function* lines(result, { lines: told, marks }) {
  for (const { heading, text } of told) {
    yield element("p", {}, heading ? element("b", {}, `${heading} `) : null, text);
  }
  if (result.status === "planned") {
    for (const note of result.notes) yield element("p", { class: "asked" }, note);
  }
  if (!marks.length) return;
  yield element("p", {}, "Marked on the table:");
  yield element("ul", { class: "marks" }, ...marks.map((mark) =>
    element("li", { "data-about": mark.about ?? mark.kind }, mark.text)));
}
