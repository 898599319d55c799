// Buttons and keys with which a recording is played: play, speed, steps, predicted end.

import { Vector3 } from "./vendor/three.module.min.js";
import { Timeline, linesOf, made } from "./timeline.js";

const STEP = 0.2; // of an arrow key [s]
const READ = 120; // between figures that can be read [ms]
const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];

export class PlayControls {
  constructor() {
    this.player = null;
    this.timeline = new Timeline((time) => this.#seek(time));
    this.playing = made("button", { id: "play", type: "button", "aria-label": "Play" });
    this.clock = made("b", { id: "clock" }, "0.0");
    this.duration = made("span", { id: "duration" });
    this.speed = made("select", { id: "speed" },
      ...SPEEDS.map((each) => made("option", { value: String(each) }, `${each} ×`)));
    this.speed.value = "1";
    this.element = made("div", { id: "controls" },
      this.playing,
      made("span", { class: "times" }, this.clock, " / ", this.duration),
      made("label", {}, "speed ", this.speed),
      hint(),
    );
    this.playing.addEventListener("click", () => this.#toggle());
    this.speed.addEventListener("change", () => this.#choose(Number(this.speed.value)));
    document.addEventListener("keydown", (event) => this.#press(event));
  }

  // Plays a recording from now on; `pill` is the element that shows the force at the finger.
  take(player, recording, story, pill) {
    this.player = player;
    const lines = linesOf(recording);
    this.timeline.draw(lines);
    this.duration.textContent = `${lines.end.toFixed(1)} s`;
    player.onshow((time, frame) => {
      if (this.playing.dataset.playing !== String(player.playing)) {
        this.playing.setAttribute("aria-label", player.playing ? "Pause" : "Play");
        this.playing.dataset.playing = String(player.playing);
      }
      if (this.timeline.show(time, lines.felt[frame], { hurry: player.playing })) {
        this.clock.textContent = time.toFixed(1);
      }
    });
    followAttempts(player, story.contacts);
    labelForce(player, lines.felt, pill);
    this.#choose(1);
    player.seek(player.time);
  }

  // Plays nothing any more.
  leave() {
    if (!this.player) return;
    this.player.viewer.ondrawn = null;
    this.player = null;
  }

  #toggle() {
    if (this.player?.playing) this.player.pause();
    else this.player?.play();
  }

  #seek(time) {
    this.player?.pause();
    this.player?.seek(time);
  }

  #step(seconds) {
    this.#seek(this.player.time + seconds);
  }

  #choose(speed) {
    if (this.player) this.player.speed = speed;
    this.speed.value = String(speed);
  }

  #faster(by) {
    const at = SPEEDS.indexOf(this.player.speed) + by;
    this.#choose(SPEEDS[Math.min(Math.max(at, 0), SPEEDS.length - 1)]);
  }

  #press(event) {
    const keys = {
      " ": () => this.#toggle(), k: () => this.#toggle(),
      ArrowLeft: () => this.#step(-STEP), ArrowRight: () => this.#step(STEP),
      ",": () => this.#step(-1 / 30), ".": () => this.#step(1 / 30),
      "-": () => this.#faster(-1), "+": () => this.#faster(1),
      Home: () => this.#step(-Infinity), End: () => this.#step(Infinity),
      0: () => this.player.viewer.orbit.reset(),
    };
    const busy = event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented;
    const { target } = event;
    const written = target.closest("input:not([type=checkbox], #time), textarea, select");
    const pressed = event.key === " " && target.closest("button, a, summary, input[type=checkbox]");
    if (!this.player || busy || !keys[event.key] || written || pressed) return;
    event.preventDefault();
    keys[event.key]();
  }
}

function hint() {
  const key = (name) => made("kbd", {}, name);
  return made("span", { class: "hint" },
    key("space"), " play ", key("←"), key("→"), " step ", key("−"), key("+"),
    " speed · drag to turn, wheel to zoom");
}

// Each push has contacts of its own, which are shown from a time on until the next ones are.
function followAttempts(player, contacts) {
  const times = [...new Set(contacts.map((each) => each.since))];
  let shown = null;
  player.onshow((time) => {
    const since = times.findLast((each) => each <= time) ?? times[0];
    if (since === shown) return;
    shown = since;
    player.viewer.setContacts(contacts.filter((each) => each.since === since));
  });
}

// What is felt, beside the finger that presses most.
function labelForce(player, felt, pill) {
  const { viewer } = player;
  let written = 0;
  viewer.ondrawn = () => {
    const { frame, fingers } = player;
    let [most, place] = [0, null];
    for (const { places, forces } of fingers) {
      const force = Math.hypot(...forces[frame]);
      if (force > most) [most, place] = [force, places[frame]];
    }
    const hurry = player.playing && performance.now() - written < READ;
    showPill(viewer, pill, place, hurry ? null : felt[frame]);
    if (!hurry) written = performance.now();
  };
}

// Shows a force [N] beside a place in W, or hides it; null leaves the figure as it is.
export function showPill(viewer, pill, place, newtons) {
  const at = place && viewer.project(new Vector3(...place));
  if (pill.hidden === Boolean(at)) pill.hidden = !at;
  if (!at) return;
  pill.style.transform = `translate(${Math.round(at[0] + 34)}px, ${Math.round(at[1] - 12)}px)`;
  if (newtons !== null) pill.textContent = `${newtons.toFixed(1)} N`;
}
