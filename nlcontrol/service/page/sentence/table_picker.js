// The table that is spoken of: its scene and seed, whether plans are looked at first, and its link.

import { addressOf } from "../address.js";
import { element } from "../elements.js";
import { openSession } from "../open_session.js";

export function tablePicker(state, api) {
  const scene = element("select", { id: "scene" });
  const seed = element("input", { id: "seed", type: "number", min: 0, max: 2 ** 32 - 1, step: 1, required: true });
  const atOnce = element("input", { id: "at-once", type: "checkbox" });
  const open = () => {
    if (seed.reportValidity()) openSession(state, api, scene.value, seed.valueAsNumber);
  };
  scene.addEventListener("change", open);
  seed.addEventListener("change", open);
  atOnce.addEventListener("change", () => state.set({ mode: atOnce.checked ? "at_once" : "approve" }));
  state.on(["scenes", "scene", "seed"], () => {
    const names = state.get("scenes").map(({ name }) => name);
    scene.replaceChildren(...names.map((name) => element("option", { value: name }, name)));
    scene.value = state.get("scene");
    seed.value = String(state.get("seed"));
  });
  state.on(["mode", "session"], () => {
    atOnce.checked = state.get("mode") === "at_once";
    atOnce.disabled = state.get("session")?.spec.approval === "plan";
  });
  return element("div", { id: "table" },
    element("label", {}, "scene ", scene), element("label", {}, "seed ", seed),
    element("label", { title: "Carry sentences out without showing the plan first" }, atOnce, " do at once"),
    shareButton(state));
}

// Copies the link that fills in sentence, scene and seed for others.
function shareButton(state) {
  const button = element("button", { type: "button", id: "share" }, "Copy link");
  button.addEventListener("click", async () => {
    const link = shareLink(state);
    try {
      await navigator.clipboard.writeText(link);
      button.textContent = "Copied";
    } catch {
      history.replaceState(null, "", link); // where there is no clipboard, the address has it
      button.textContent = "See the address bar";
    }
    setTimeout(() => (button.textContent = "Copy link"), 2000);
  });
  return button;
}

export function shareLink(state) {
  return addressOf({ text: state.get("text").trim(), scene: state.get("scene"), seed: state.get("seed") });
}
