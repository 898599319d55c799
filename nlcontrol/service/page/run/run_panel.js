// The run as it happens, and its verdict.

import { element, section } from "../elements.js";
import { isUnderWay } from "../app_state.js";
import { tellProblem } from "../problems.js";
import { askedText, doubtText, valueText, VERDICTS, wordsOf } from "./check_text.js";
import { followRun } from "./follow_run.js";
import { lightWords, saidWords } from "./said_words.js";

const WORDS = {
  done: "done", failed: "not as asked", undecided: "undecided", cancelled: "stopped", refused: "refused", answered: "answered",
  not_understood: "not understood", unsupported: "not possible here", planned: "planned",
};
const LOST = { aborted: "aborted", cut_off: "cut off", defect: "internal error" };

export function runPanel(state, api) {
  followRun(state, api);
  const sentence = element("p", { class: "sentence" });
  const badge = element("span", { class: "badge" });
  const phase = element("p", { class: "phase-now" });
  const stop = element("button", { type: "button", id: "stop" }, "Stop ", element("kbd", {}, "Esc"));
  const verdicts = element("ul", { class: "verdicts" });
  const learned = element("div");
  const files = element("p", { class: "files" });
  const status = element("div", { role: "status" }, badge, phase);
  const panel = section("Run", { id: "run", hidden: true }, sentence, status, stop, verdicts, learned, files);
  const ask = () => stopRun(state, api, stop);
  stop.addEventListener("click", ask);
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && !event.defaultPrevented && isUnderWay(state.get("run"))) ask();
  });
  state.on(["run", "result", "understanding", "connection"], () => {
    const run = state.get("run");
    panel.hidden = !isUnderWay(run) && !state.get("result") && !LOST[run?.state];
    if (panel.hidden) return;
    sentence.replaceChildren(...saidWords(run.text, rowsOf(state, run.text)));
    badge.textContent = statusText(run);
    badge.hidden = isUnderWay(run);
    badge.dataset.ok = String(Boolean(run.result?.ok));
    badge.dataset.status = run.result?.status ?? "";
    stop.hidden = !isUnderWay(run) || state.get("connection") === "no_answer";
    if (stop.hidden) stop.disabled = false;
    files.replaceChildren(...(isUnderWay(run) ? [] : links(api, run)));
  });
  state.on(["run", "events"], () => {
    const run = state.get("run");
    if (run) phase.textContent = phaseText(run, state.get("events"));
  });
  state.on(["run", "events", "result"], () => {
    const checks = checksOf(state);
    verdicts.replaceChildren(...checks.map((check) => verdict(state.get("run").text, check, sentence)));
    learned.replaceChildren(...notesOf(state).map(([kind, text]) => element("p", { class: kind }, text)));
  });
  return panel;
}

async function stopRun(state, api, button) {
  button.disabled = true;
  try {
    await api.stop(state.get("run").run_id);
  } catch (problem) {
    button.disabled = false;
    tellProblem(state, problem);
  }
}

// Which words became which part, if that is known of this sentence.
function rowsOf(state, text) {
  const read = state.get("understanding");
  return state.get("result")?.explanation ?? (read?.text === text ? read.explanation : []) ?? [];
}

// How a run ended, in a word or two.
export function statusText(run) {
  if (run.result) return WORDS[run.result.status];
  return LOST[run.state] ?? "";
}

function phaseText(run, events) {
  if (run.ended_at !== null) return run.result?.error?.message ?? run.error?.message ?? "";
  if (run.state === "queued") return `in the queue, place ${run.place ?? 1}`;
  const last = events.findLast(({ event }) => event.kind === "phase")?.event;
  if (!last) return "plans";
  const name = last.phase.replaceAll("_", " ");
  return last.text && last.text !== name ? `${name}: ${last.text}` : name;
}

function checksOf(state) {
  const result = state.get("result");
  if (!result) {
    return state.get("events").filter(({ event }) => event.check).map(({ event }) => event.check);
  }
  const checks = result.steps.flatMap((step) => step.checks);
  return checks.length ? checks : result.checks;
}

// What a run taught, and what else is to be said of it.
function notesOf(state) {
  const lessons = state.get("events").filter(({ event }) => event.lesson);
  const notes = state.get("result")?.notes ?? [];
  return [...lessons.map(({ event }) => ["lesson", event.text]), ...notes.map((text) => ["asked", text])];
}

function verdict(text, check, sentence) {
  const light = (on) => () => lightWords(sentence, check.spans, on);
  const said = wordsOf(text, check.spans);
  const [sign, meaning] = VERDICTS[check.verdict];
  return element("li", {
    "data-verdict": check.verdict, tabindex: 0,
    onpointerenter: light(true), onpointerleave: light(false), onfocus: light(true), onblur: light(false),
  },
    element("span", { class: "mark", role: "img", "aria-label": meaning }, sign),
    element("div", {},
      said ? element("span", { class: "said" }, `“${said}”`) : null,
      `${check.quantity}: `, element("b", {}, valueText(check.measured, check.unit)),
      element("span", { class: "asked" }, askedText(check) + doubtText(check))));
}

// Files of a run that has ended.
export function links(api, run) {
  const moved = Boolean(run.result?.execution);
  return [
    element("a", { href: api.fileOf(run.run_id, "bundle"), download: "" }, "Bundle"),
    ...(moved ? [element("a", { href: api.fileOf(run.run_id, "replay"), download: `${run.run_id}.html` }, "Replay file")] : []),
  ];
}
