// The field of the sentence: its words light up, and it goes on with what fits.

import { element } from "../elements.js";
import { completions } from "./completion.js";
import { examplesFor } from "./examples.js";
import { saySentence, typeText } from "./sentence_reading.js";
import { lightedWords } from "./word_lights.js";

export function sentencePanel(state, api) {
  const lights = element("div", { id: "lights", "aria-hidden": "true" });
  const field = element("input", {
    id: "say", name: "say", type: "text", role: "combobox", autocomplete: "off", spellcheck: "false",
    autocapitalize: "off", maxlength: 2000, enterkeyhint: "go", "aria-label": "Sentence",
    "aria-autocomplete": "list", "aria-expanded": "false", "aria-controls": "completions",
  });
  const list = element("ul", { id: "completions", role: "listbox", "aria-label": "Completions", hidden: true });
  const button = element("button", { class: "primary" });
  const form = element("form", { id: "sentence" }, element("div", { id: "field" }, lights, field, list), button);
  const options = completionList(state, field, list, (text) => typeText(state, api, text));
  field.addEventListener("input", () => {
    typeText(state, api, field.value);
    options.show();
  });
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    options.hide();
    saySentence(state, api, field.value.trim());
  });
  for (const event of ["scroll", "keyup", "pointerup", "blur"]) {
    field.addEventListener(event, () => (lights.scrollLeft = field.scrollLeft));
  }
  state.on(["text", "understanding"], () => {
    if (field.value !== state.get("text")) field.value = state.get("text");
    showLights(state, lights);
    lights.scrollLeft = field.scrollLeft;
  });
  state.on(["table"], () => (field.placeholder = examplesFor(state)[0] ?? ""));
  state.on(["asking"], () => {
    button.textContent = state.get("asking") ? "Planning …" : "Plan";
    button.setAttribute("aria-busy", String(state.get("asking")));
  });
  return form;
}

function showLights(state, lights) {
  const [text, read] = [state.get("text"), state.get("understanding")];
  const goesOn = read && text.startsWith(read.text.trimEnd());
  const marked = read?.text === text && !read.unfinished;
  lights.replaceChildren(...lightedWords(text, goesOn ? read.explanation : [], marked ? read.error : null));
}

// The list of completions under the field, moved through by the arrow keys.
function completionList(state, field, list, take) {
  let found = [];
  let chosen = -1;
  const choose = (index) => {
    chosen = index;
    [...list.children].forEach((item, i) => item.setAttribute("aria-selected", String(i === index)));
    if (index >= 0) field.setAttribute("aria-activedescendant", `completion-${index}`);
    else field.removeAttribute("aria-activedescendant");
  };
  const show = () => {
    const complete = Boolean(state.get("understanding")?.ok);
    const atEnd = field.selectionStart === field.value.length;
    found = atEnd ? completions(field.value, namesOf(state), complete) : [];
    list.replaceChildren(...found.map(({ phrase }, i) => element("li", {
      id: `completion-${i}`, role: "option", "aria-selected": "false",
      onpointerdown: (event) => {
        event.preventDefault(); // the field keeps the focus
        accept(i);
      },
    }, phrase)));
    list.hidden = !found.length;
    field.setAttribute("aria-expanded", String(!list.hidden));
    choose(-1);
  };
  const hide = () => {
    found = [];
    list.hidden = true;
    field.setAttribute("aria-expanded", "false");
    choose(-1);
  };
  const accept = (index) => {
    field.value = found[index].text;
    take(field.value);
    show();
  };
  field.addEventListener("keydown", (event) => {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step && found.length) {
      event.preventDefault();
      choose((chosen + step + (chosen < 0 && step < 0 ? 1 : 0) + found.length) % found.length);
    } else if (["Enter", "Tab"].includes(event.key) && chosen >= 0) {
      event.preventDefault();
      accept(chosen);
    } else if (event.key === "Escape") hide();
  });
  field.addEventListener("blur", hide);
  return { show, hide };
}

function namesOf(state) {
  const { objects = [] } = state.get("table") ?? {};
  const models = new Map(state.get("objects").map((model) => [model.name, model]));
  const synonyms = objects.flatMap((each) => models.get(each.model)?.synonyms ?? []);
  return [...new Set([...objects.map((each) => each.name), ...synonyms])];
}
