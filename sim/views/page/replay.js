// The page of a replay: the sentence, what was understood and foreseen, the run, the verdict.

import { PlayControls } from "./play_controls.js";
import { LivePlayer, RecordingPlayer } from "./player.js";
import { Viewer } from "./viewer.js";

// The mark of a verdict, and what it means.
const VERDICTS = {
  held: ["✓", "held"], not_held: ["✗", "did not hold"], unknown: ["?", "cannot tell"],
};

const $ = (id) => document.getElementById(id);

function element(name, text = "", classes = "") {
  const made = document.createElement(name);
  made.textContent = text;
  if (classes) made.className = classes;
  return made;
}

export function showReplay({ scene, recording, story }) {
  const viewer = new Viewer($("view"), scene);
  viewer.orbit.setHome(recording.view);
  const player = new RecordingPlayer(viewer, recording);
  viewer.orbit.jump();
  tell(story);
  viewer.setGhosts(story.ghosts);
  $("ghost-key").hidden = !story.ghosts.length;
  connectView(viewer);
  const controls = new PlayControls();
  $("run").append(controls.timeline.element, controls.element);
  controls.take(player, recording, story, $("force"));
  if (!matchMedia("(prefers-reduced-motion: reduce)").matches) player.play();
  Object.assign(document.documentElement.dataset, { ready: "true" });
  globalThis.replay = { viewer, player, LivePlayer }; // for whoever looks into the page
}

// -- what is told ---------------------------------------------------------------------------------

function tell(story) {
  const sentence = $("sentence");
  sentence.replaceChildren(...story.words.map(({ text, part, start, end }) => {
    const word = element("span", text, "word");
    if (part) word.dataset.part = part;
    Object.assign(word.dataset, { start, end });
    return word;
  }));
  $("status").textContent = story.status;
  $("status").dataset.ok = String(story.ok);
  $("status").dataset.status = story.status;
  $("status").hidden = !story.status;
  const same = story.understood.toLowerCase() === story.title.trim().toLowerCase();
  const without = (story.left_out ?? []).map((said) => `“${said}”`).join(", ");
  $("understood").textContent = [
    same || !story.understood ? "" : `understood: ${story.understood}`,
    without && `left out: ${without}`,
  ].filter(Boolean).join(" · ");
  tellVerdicts(story);
  section("prediction", story.prediction.map(({ heading, text }) => {
    const line = element("p");
    line.append(element("b", heading), ` ${text}`);
    return line;
  }));
  section("parameters", story.rows.map((row) => {
    const line = element("tr");
    const words = element("td", row.words || "(not said)");
    words.dataset.part = row.part;
    line.append(words, element("td", row.parameter), element("td", row.value));
    if (row.problem) line.dataset.problem = "true";
    return line;
  }));
  section("notes", story.notes.map((text) => element("p", text)));
}

function section(id, content) {
  $(id).replaceChildren(...content);
  $(id).closest("section").hidden = !content.length;
}

function tellVerdicts(story) {
  section("verdicts", story.clauses.map((clause) => {
    const item = element("li");
    const [sign, meaning] = VERDICTS[clause.verdict];
    item.dataset.verdict = clause.verdict;
    const mark = element("span", sign, "mark");
    mark.setAttribute("role", "img");
    mark.setAttribute("aria-label", meaning);
    const told = element("div");
    if (clause.said) told.append(element("span", `“${clause.said}”`, "said"));
    told.append(
      element("span", `${clause.quantity}: `, "quantity"), element("b", clause.measured),
      element("span", clause.asked, "asked"),
    );
    item.append(mark, told);
    const light = (on) => lightWords(clause.spans, on);
    item.addEventListener("pointerenter", () => light(true));
    item.addEventListener("pointerleave", () => light(false));
    return item;
  }));
}

function lightWords(spans, on) {
  for (const word of document.querySelectorAll(".word")) {
    const [start, end] = [Number(word.dataset.start), Number(word.dataset.end)];
    const within = spans.some(([from, to]) => start < to && from < end);
    word.classList.toggle("lit", on && within);
  }
}

// -- controls -------------------------------------------------------------------------------------

function connectView(viewer) {
  $("home").addEventListener("click", () => viewer.orbit.reset());
  $("ghost").addEventListener("change", (event) => {
    viewer.ghosts.visible = event.target.checked;
    viewer.invalidate();
  });
  document.addEventListener("keydown", (event) => {
    if (event.key === "g" && !event.ctrlKey && !event.metaKey && !event.altKey) $("ghost").click();
  });
}
