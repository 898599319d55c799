// Sentences to try on the table that stands here.

import { element } from "../elements.js";
import { EXAMPLES } from "./phrases.js";
import { saySentence } from "./sentence_reading.js";

// Each about another object of the table.
export function examplesFor(state) {
  const { objects = [] } = state.get("table") ?? {};
  if (!objects.length) return [];
  return EXAMPLES.map((each, i) => each.replace("%", objects[i % objects.length].name));
}

// The examples as buttons that fill in the field and say it.
export function examplesPanel(state, api) {
  const list = element("ul", { class: "choices" });
  const panel = element("section", { id: "examples", "aria-label": "Examples" },
    element("h2", {}, "Try one of these"), list);
  state.on(["table", "offer", "answer", "run", "problem", "understanding"], () => {
    list.replaceChildren(...examplesFor(state).map((text) =>
      element("li", {}, element("button", { type: "button", onclick: () => saySentence(state, api, text) }, text))));
    const busy = ["offer", "answer", "run", "understanding"].some((key) => state.get(key));
    panel.hidden = busy || !list.children.length;
  });
  return panel;
}
