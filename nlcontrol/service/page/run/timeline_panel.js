// The force over the time of a run.

import { element } from "../elements.js";

export function timelinePanel(state, api, view) {
  return element("section", { hidden: true });
}
