// What was understood: the sentence in its colours, and what each part became, or what stands in the way.

import { element, section } from "../elements.js";
import { saySentence } from "./sentence_reading.js";
import { lightedWords } from "./word_lights.js";

const SHORT = 80; // letters that the field shows at once

export function understandingPanel(state, api) {
  const words = element("p", { class: "sentence" });
  const meant = element("p", { class: "asked" });
  const problem = element("div", { role: "status" });
  const panel = section("Understood", { id: "understood" }, words, meant, problem);
  state.on(["understanding"], () => {
    const read = state.get("understanding");
    panel.hidden = !read;
    if (!read) return;
    const error = read.unfinished ? null : read.error;
    words.replaceChildren(...lightedWords(read.text, read.explanation, error));
    const same = !read.paraphrase || read.paraphrase.toLowerCase() === read.text.trim().toLowerCase();
    const without = read.left_out.map((said) => `“${said}”`).join(", ");
    meant.textContent = [same ? "" : `understood: ${read.paraphrase}`, without && `left out: ${without}`]
      .filter(Boolean).join(" · ");
    // A short sentence stands in the field already, where that is wide.
    const isShort = read.text.length < SHORT;
    words.dataset.short = String(isShort);
    panel.dataset.bare = String(isShort && same && !without && !error);
    problem.replaceChildren(...(error ? problemContent(state, api, read.status, error) : []));
  });
  return panel;
}

// What stands in the way, and what can be said instead; why there is no plan is told with the plans.
function problemContent(state, api, status, { message, suggestions, say }) {
  const told = status === "refused" ? [] : [element("p", { class: "problem" }, sentenceCase(message))];
  const sentences = say.map((text) =>
    element("li", {}, element("button", { type: "button", onclick: () => saySentence(state, api, text) }, text)));
  if (sentences.length) told.push(element("p", {}, "Say instead:"), element("ul", { class: "choices" }, ...sentences));
  else told.push(...suggestions.map((text) => element("p", { class: "asked" }, sentenceCase(text))));
  return told;
}

// What each part of the sentence became.
export function parametersPanel(state) {
  const rows = element("tbody");
  const panel = section("From the words to the controller", { id: "parameters" }, element("table", {}, rows));
  state.on(["understanding"], () => {
    const { error, explanation = [] } = state.get("understanding") ?? {};
    rows.replaceChildren(...(error ? [] : tableRows(explanation)));
    panel.hidden = !rows.children.length;
  });
  return panel;
}

function sentenceCase(text) {
  return `${text.slice(0, 1).toUpperCase()}${text.slice(1)}`;
}

// One row for each parameter; the words and the part stand at the first of theirs.
function tableRows(explanation) {
  let before = "";
  return explanation.filter((row) => row.part !== "filler").map((row) => {
    const key = `${row.frame} ${row.part} ${row.field}`;
    const words = element("td", { "data-part": row.part });
    if (key !== before) words.append(row.words || "(not said)");
    before = key;
    const became = row.parameter || row.field;
    return element("tr", { "data-problem": row.problem || null, "data-default": row.default || null },
      words, element("td", {}, became), element("td", {}, row.value));
  });
}
