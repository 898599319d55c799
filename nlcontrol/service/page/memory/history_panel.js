// Runs that have ended: looked at again, taken along as bundles, deleted.

import { element } from "../elements.js";
import { tellProblem } from "../problems.js";
import { links, statusText } from "../run/run_panel.js";
import { showRun } from "../run/show_run.js";

const PAGE = 20; // runs that are asked for at once

export function historyPanel(state, api) {
  const list = element("ul", { class: "runs" });
  const more = element("button", { type: "button", hidden: true }, "Older runs");
  const none = element("p", { class: "asked" }, "No runs yet.");
  const panel = element("details", { id: "history" }, element("summary", {}, "History"), none, list, more);
  let cursor = null;
  const load = async (after) => {
    try {
      const page = await api.runs(after ? { limit: PAGE, cursor: after } : { limit: PAGE });
      const items = page.runs.filter((run) => run.ended_at !== null).map((run) => item(state, api, run));
      if (after) list.append(...items);
      else list.replaceChildren(...items);
      cursor = page.cursor;
      more.hidden = !cursor;
      none.hidden = list.children.length > 0;
    } catch (problem) {
      tellProblem(state, problem);
    }
  };
  more.addEventListener("click", () => load(cursor));
  panel.addEventListener("toggle", () => panel.open && load(null));
  state.on(["result"], () => panel.open && load(null));
  return element("section", { "aria-label": "History" }, panel);
}

function item(state, api, run) {
  const when = new Date(1000 * run.asked_at);
  const made = element("li", {});
  const open = element("button", { type: "button", class: "run", onclick: () => showRun(state, api, run) },
    run.text || "(frames)");
  const drop = element("button", { type: "button", class: "drop", "aria-label": `Delete the run: ${run.text}` }, "Delete");
  drop.addEventListener("click", async () => {
    if (drop.dataset.asked !== "true") {
      drop.dataset.asked = "true";
      drop.textContent = "Delete it?";
      drop.addEventListener("blur", () => {
        drop.dataset.asked = "false";
        drop.textContent = "Delete";
      }, { once: true });
      return;
    }
    try {
      await api.deleteRun(run.run_id);
      made.remove();
    } catch (problem) {
      tellProblem(state, problem);
    }
  });
  made.append(open, element("span", { class: "asked" },
    [statusText(run), tableText(run), ""].filter((each) => each !== null).join(" · "),
    element("time", { datetime: when.toISOString() }, when.toLocaleString())),
  element("span", { class: "files" }, ...links(api, run), drop));
  return made;
}

// The table of a run; null of one that an earlier version has kept.
function tableText({ scene, seed }) {
  return scene === null ? null : `${scene}, seed ${seed}`;
}
