// What is foreseen before anything moves.

import { element } from "../elements.js";

export function predictionPanel(state, api, view) {
  return element("section", { hidden: true });
}
