// Runs that have ended.

import { element } from "../elements.js";

export function historyPanel(state, api, view) {
  return element("section", { hidden: true });
}
