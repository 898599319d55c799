// Objects and scenes to look at.

import { element } from "../elements.js";

export function libraryPanel(state, api, view) {
  return element("section", { hidden: true });
}
