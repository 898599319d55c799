// The sentence: its field, and what is done with it.

import { element } from "../elements.js";
import { isGivenUp } from "../service_api.js";

export function sentencePanel(state, api) {
  const field = element("input", {
    id: "say", name: "say", type: "text", autocomplete: "off", spellcheck: "false", maxlength: 2000,
    placeholder: "push the ice tea box away without toppling it", "aria-label": "Sentence",
    oninput: () => state.set({ text: field.value }),
  });
  const plan = async (event) => {
    event.preventDefault();
    await takeSentence(state, api, field.value.trim());
  };
  state.on(["text"], () => {
    if (field.value !== state.get("text")) field.value = state.get("text");
  });
  return element("form", { id: "sentence", onsubmit: plan },
    field, element("button", { class: "primary" }, "Plan"));
}

// Plans a sentence, or does it at once, as the mode says; a question is answered.
export async function takeSentence(state, api, text) {
  if (!text || !state.get("session")) return;
  state.set({ text, answer: null, offer: null, result: null, problem: null });
  try {
    if (state.get("mode") === "at_once") {
      state.set({ run: await api.say(text), events: [] });
      return;
    }
    const offer = await api.plan(text);
    state.set(offer.result.status === "answered" ? { answer: offer.result } : { offer });
  } catch (problem) {
    if (!isGivenUp(problem)) state.set({ problem });
  }
}
