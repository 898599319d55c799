// The page of a replay: the sentence, what was understood and foreseen, the run, the verdict.

import { Vector3 } from "./vendor/three.module.min.js";
import { forceChart } from "./force_chart.js";
import { series } from "./frame_track.js";
import { LivePlayer, RecordingPlayer } from "./player.js";
import { Viewer } from "./viewer.js";

const STEP = 0.2; // of an arrow key [s]
const READ = 120; // between figures that can be read [ms]
const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];
const SHORT = 0.07; // share of the time below which a phase goes without its name

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
  tell(story);
  viewer.setGhosts(story.ghosts);
  $("ghost-key").hidden = !story.ghosts.length;
  const felt = drawTimeline(player, recording);
  followAttempts(viewer, player, story.contacts);
  connectControls(viewer, player);
  labelForce(viewer, player, felt);
  player.seek(player.time);
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
  $("status").hidden = !story.status;
  const same = story.understood.toLowerCase() === story.title.trim().toLowerCase();
  $("understood").textContent = same || !story.understood ? "" : `understood: ${story.understood}`;
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
    item.dataset.ok = String(clause.ok);
    const mark = element("span", clause.ok ? "✓" : "✗", "mark");
    mark.setAttribute("role", "img");
    mark.setAttribute("aria-label", clause.ok ? "held" : "did not hold");
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

// -- time -----------------------------------------------------------------------------------------

function drawTimeline(player, recording) {
  const { end } = player;
  const begins = recording.phases;
  const band = $("phases");
  begins.forEach(({ phase, time }, i) => {
    const share = ((begins[i + 1]?.time ?? end) - time) / end;
    const part = element("span", share > SHORT ? phase.replaceAll("_", " ") : "", "phase");
    part.dataset.phase = phase;
    part.title = phase.replaceAll("_", " ");
    part.style.flexGrow = String(share);
    band.append(part);
  });
  for (const { time, bodies } of recording.touches) {
    const tick = element("span", "", "touch");
    tick.style.left = `${(100 * time) / end}%`;
    tick.title = `${bodies.join(" touches ")}`;
    band.append(tick);
  }
  const { force } = recording;
  const told = { times: player.track.times, felt: flat(force.felt), limit: flat(force.limit) };
  $("chart").hidden = !force.label;
  $("force-label").textContent = force.label;
  $("limit-label").hidden = !told.limit.some((value) => value > 0);
  if (force.label) forceChart($("chart"), told);
  $("time").max = String(end);
  $("duration").textContent = `${end.toFixed(1)} s`;
  const wide = new ResizeObserver(([{ contentRect }]) => (width = contentRect.width));
  let width = 0;
  let before = 0;
  wide.observe($("timeline"));
  player.onshow((time, frame) => {
    $("cursor").style.transform = `translateX(${((width * time) / end).toFixed(1)}px)`;
    // Figures need not change more often than they can be read.
    if (player.playing && performance.now() - before < READ) return;
    before = performance.now();
    $("time").value = String(time);
    const phase = begins.findLast((each) => each.time <= time + 1e-6)?.phase ?? "";
    $("time").setAttribute("aria-valuetext", `${time.toFixed(1)} s, ${phase}`);
    $("clock").textContent = time.toFixed(1);
    $("newtons").textContent = `${told.felt[frame].toFixed(1)} N`;
    document.documentElement.dataset.ended = String(time >= end);
  });
  return told.felt;
}

function flat(packed) {
  return series(packed).map(([value]) => value);
}

// Each push has contacts of its own, which are shown from a time on until the next ones are.
function followAttempts(viewer, player, contacts) {
  const times = [...new Set(contacts.map((each) => each.since))];
  let shown = null;
  player.onshow((time) => {
    const since = times.findLast((each) => each <= time) ?? times[0];
    if (since === shown) return;
    shown = since;
    viewer.setContacts(contacts.filter((each) => each.since === since));
  });
}

// What is felt, beside the finger that presses most.
function labelForce(viewer, player, felt) {
  const label = $("force");
  let written = 0;
  viewer.ondrawn = () => {
    const { frame, fingers } = player;
    let [most, place] = [0, null];
    for (const { places, forces } of fingers) {
      const force = Math.hypot(...forces[frame]);
      if (force > most) [most, place] = [force, places[frame]];
    }
    const at = place && viewer.project(new Vector3(...place));
    if (label.hidden === Boolean(at)) label.hidden = !at;
    if (!at) return;
    label.style.transform = `translate(${Math.round(at[0] + 34)}px, ${Math.round(at[1] - 12)}px)`;
    const now = performance.now();
    if (player.playing && now - written < READ) return;
    written = now;
    label.textContent = `${felt[frame].toFixed(1)} N`;
  };
}

// -- controls -------------------------------------------------------------------------------------

function connectControls(viewer, player) {
  const play = $("play");
  const toggle = () => (player.playing ? player.pause() : player.play());
  player.onshow(() => {
    if (play.dataset.playing === String(player.playing)) return;
    play.setAttribute("aria-label", player.playing ? "Pause" : "Play");
    play.dataset.playing = String(player.playing);
  });
  play.addEventListener("click", toggle);
  $("time").addEventListener("input", (event) => {
    const time = Number(event.target.value); // which a pause sets back
    player.pause();
    player.seek(time);
  });
  const speed = $("speed");
  const choose = (value) => {
    player.speed = value;
    speed.value = String(value);
  };
  speed.replaceChildren(...SPEEDS.map((each) => {
    const option = element("option", `${each} ×`);
    option.value = String(each);
    return option;
  }));
  choose(1);
  speed.addEventListener("change", () => choose(Number(speed.value)));
  $("home").addEventListener("click", () => viewer.orbit.reset());
  $("ghost").addEventListener("change", (event) => {
    viewer.ghosts.visible = event.target.checked;
    viewer.invalidate();
  });
  const faster = (by) => {
    const at = SPEEDS.indexOf(player.speed) + by;
    choose(SPEEDS[Math.min(Math.max(at, 0), SPEEDS.length - 1)]);
  };
  const step = (seconds) => {
    player.pause();
    player.seek(player.time + seconds);
  };
  const keys = {
    " ": toggle, k: toggle, ArrowLeft: () => step(-STEP), ArrowRight: () => step(STEP),
    ",": () => step(-1 / 30), ".": () => step(1 / 30), "-": () => faster(-1), "+": () => faster(1),
    Home: () => step(-Infinity), End: () => step(Infinity), 0: () => viewer.orbit.reset(),
    g: () => $("ghost").click(),
  };
  document.addEventListener("keydown", (event) => {
    const busy = event.ctrlKey || event.metaKey || event.altKey;
    const typed = event.target.closest("button, select, summary, input[type=checkbox]");
    if (busy || !keys[event.key] || (typed && event.key === " ") || event.target === speed) return;
    event.preventDefault();
    keys[event.key]();
  });
}
