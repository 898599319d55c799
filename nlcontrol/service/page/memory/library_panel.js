// Objects and scenes to look at: shapes, what is believed of them, what can be done with them.

import { Vector3 } from "/viewer/vendor/three.module.min.js";
import { element } from "../elements.js";
import { openSession } from "../open_session.js";
import { affordanceList } from "./affordance_list.js";
import { ObjectView } from "./object_view.js";
import { parameterTable } from "./parameter_table.js";
import { tellProblem } from "../problems.js";

export function libraryPanel(state, api, view) {
  const objects = element("ul", { class: "chips", "aria-label": "Objects" });
  const shown = element("div", { id: "looked-at", role: "region", "aria-label": "Object", hidden: true });
  const scenes = element("ul", { class: "chips", "aria-label": "Scenes" });
  const panel = element("details", { id: "library" }, element("summary", {}, "Objects and scenes"),
    element("h3", {}, "Objects"), objects, shown, element("h3", {}, "Scenes"), scenes);
  const shape = new ObjectView();
  const look = async (name, onTable) => {
    try {
      shown.replaceChildren(...described(await api.object(onTable?.model ?? name), name, onTable, shape, { state, api }));
      shown.hidden = false;
      if (onTable) followObject(view.viewer, onTable);
    } catch (problem) {
      tellProblem(state, problem);
    }
  };
  state.on(["objects", "table"], () => {
    const seen = state.get("table")?.objects ?? [];
    const others = state.get("objects").filter(({ name }) => !seen.some(({ model }) => model === name));
    objects.replaceChildren(
      ...seen.map((each) => chip(each.name, "on this table", () => look(each.name, each))),
      ...others.map(({ name }) => chip(name, "", () => look(name))));
  });
  state.on(["scenes", "scene"], () => {
    scenes.replaceChildren(...state.get("scenes").map(({ name, objects: things }) =>
      chip(name, things.join(", "), () => openSession(state, api, name, state.get("seed")),
        name === state.get("scene"))));
  });
  // What was pushed is believed otherwise, and stands elsewhere.
  state.on(["result"], async () => {
    if (!state.get("result") || !state.get("session")) return;
    const table = await api.look().catch(() => null);
    if (table) state.set({ table });
  });
  panel.addEventListener("toggle", () => {
    if (!panel.open) shown.hidden = true;
  });
  return element("section", { "aria-label": "Library" }, panel);
}

// Turns the camera of the table to an object.
function followObject(viewer, { x, y, size }) {
  viewer?.orbit.follow(new Vector3(x, y, size[2] / 2), 1.1);
  viewer?.invalidate();
}

function chip(name, title, onclick, current = false) {
  return element("li", {}, element("button", { type: "button", title, onclick, "aria-current": current || null }, name));
}

// An object: its shape, its figures, and what can be done with it if it stands on the table.
function* described({ summary, model, geometry }, name, onTable, shape, { state, api }) {
  yield element("h3", {}, name);
  yield shape.show(geometry, model);
  if (summary.synonyms.length) yield element("p", { class: "asked" }, `also: ${summary.synonyms.join(", ")}`);
  yield parameterTable(model, onTable);
  if (onTable) yield affordanceList(state, api, name);
  const { source } = model.provenance ?? {};
  if (source) yield element("p", { class: "asked" }, `source of the figures: ${source}`);
}
