// Below the 3-D view: force and phases of a run, live or of a recording that is played.

import { PlayControls, showPill } from "/viewer/play_controls.js";
import { isUnderWay } from "../app_state.js";
import { element } from "../elements.js";
import { tellProblem } from "../problems.js";

const LEAST = 8; // time that a live curve shows [s]
const PRESSED = ["touch", "push"]; // phases in which a force is kept below its limit

export function timelinePanel(state, api, view, tablePlayer) {
  const controls = new PlayControls();
  const pill = element("span", { class: "pill", hidden: true });
  const ghost = element("input", { type: "checkbox", id: "ghost" });
  ghost.checked = true;
  const home = element("button", { type: "button", id: "home" }, "Reset view");
  const keys = element("div", { id: "keys" }, home);
  const panel = element("section", { id: "timeline-panel", "aria-label": "Time", hidden: true },
    controls.timeline.element, controls.element);
  home.addEventListener("click", () => view.viewer?.orbit.reset());
  view.addEventListener("viewer", () => view.viewer.holder.append(pill, keys));
  tablePlayer.addEventListener("recording", () => {
    const { player, recording, story } = tablePlayer.shown;
    panel.hidden = controls.element.hidden = false;
    controls.timeline.range.disabled = false;
    controls.take(player, recording, story, pill);
  });
  tablePlayer.addEventListener("left", () => {
    controls.leave();
    pill.hidden = true;
  });
  let begin = 0; // time of the robot when the run began [s]
  let lines = null;
  state.on(["run", "events", "result"], () => {
    const run = state.get("run");
    const underWay = isUnderWay(run);
    if (!underWay && !state.get("result")) panel.hidden = true;
    const events = state.get("events");
    if (!underWay || !events.length) return;
    begin = events[0].event.time;
    lines = liveLines(events, begin, tablePlayer.live?.time ?? begin);
    panel.hidden = false;
    controls.element.hidden = controls.timeline.range.disabled = true;
    controls.timeline.draw(lines);
    followContact(tablePlayer.live, events);
  });
  tablePlayer.addEventListener("live", ({ detail: { time } }) => {
    const run = state.get("run");
    if (!lines || !isUnderWay(run)) return;
    const felt = lines.felt[lines.times.findLastIndex((each) => each <= time - begin)] ?? 0;
    controls.timeline.show(Math.min(Math.max(time - begin, 0), lines.end), felt, { hurry: true });
    const { live } = tablePlayer;
    showPill(view.viewer, pill, live.fingers[0]?.place ?? null, felt);
  });
  state.on(["result"], () => showRecording(state, api, tablePlayer));
  return panel;
}

// Times, forces and phases of a run that goes on.
function liveLines(events, begin, now) {
  const phases = [];
  const [times, felt, limit] = [[0], [0], [0]];
  let most = 0; // force that the plan allows [N]
  for (const { event } of events) {
    const time = event.time - begin;
    if (event.plan) most = event.plan.actions[0]?.force_limit ?? 0;
    if (event.kind === "phase") phases.push({ phase: event.phase, time });
    if (event.kind !== "force") continue;
    times.push(time);
    const pressed = PRESSED.includes(phases.at(-1)?.phase);
    felt.push(pressed ? Object.values(event.forces).reduce((sum, force) => sum + force, 0) : 0);
    limit.push(phases.at(-1)?.phase === "push" ? most : 0);
  }
  const last = Math.max(now, events.at(-1).event.time) - begin;
  return {
    end: Math.max(LEAST, 1.15 * last), times, felt, limit, label: "force of the push", phases, touches: [],
  };
}

// Lets the 3-D view look at what is pushed, and show what the fingers feel.
function followContact(live, events) {
  const { event } = events.at(-1);
  const planned = events.findLast((each) => each.event.plan)?.event.plan;
  if (!live || !planned) return;
  if (live.object !== planned.object) live.follow(planned.object, planned.actions[0]?.direction_W);
  if (event.forces) live.feel(event.kind === "force" ? event.forces : live.felt);
  if (event.kind === "phase" && !PRESSED.includes(event.phase)) live.feel({});
}

// Once a run has ended, it can be played again.
async function showRecording(state, api, tablePlayer) {
  const run = state.get("run");
  if (!state.get("result")?.execution) return;
  try {
    const recording = await api.recording(run.run_id);
    if (state.get("run") === run && state.get("result")) tablePlayer.show(recording);
  } catch (problem) {
    tellProblem(state, problem);
  }
}
