// The answer to a question, and the push that it is about.

import { element, section } from "../elements.js";

export function answerPanel(state) {
  const told = element("div", { role: "status" });
  const panel = section("Answer", { id: "answer" }, told);
  state.on(["answer"], () => {
    const result = state.get("answer");
    panel.hidden = !result;
    if (!result) {
      told.replaceChildren();
      return;
    }
    const { text, lines, probability, suggestions } = result.answer;
    told.replaceChildren(
      element("p", { class: "answer" }, text),
      ...lines.map((line) => element("p", {}, line)),
      ...(probability === null ? [] : [element("p", { class: "asked" }, `probability ${likelihood(probability)}`)]),
      ...suggestions.map((each) => element("p", { class: "asked" }, each)),
    );
  });
  return panel;
}

function likelihood(probability) {
  if (probability > 0.999) return "over 0.999";
  return probability < 0.001 ? "below 0.001" : probability.toFixed(3);
}
