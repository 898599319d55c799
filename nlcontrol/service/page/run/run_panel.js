// The run as it happens, and its verdict.

import { element } from "../elements.js";

export function runPanel(state, api, view) {
  return element("section", { hidden: true });
}
