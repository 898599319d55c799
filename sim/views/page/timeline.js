// The time of a run: the curve of the force with its limit, the phases below it, and a cursor.

import { forceChart } from "./force_chart.js";
import { series } from "./frame_track.js";

const READ = 120; // between figures that can be read [ms]
const SHORT = 0.07; // share of the time below which a phase goes without its name

export function made(name, attributes = {}, ...content) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...content);
  return element;
}

// What a timeline draws of a recording.
export function linesOf(recording) {
  const { times, phases, touches, force } = recording;
  const flat = (packed) => series(packed).map(([value]) => value);
  return {
    end: times[times.length - 1], times, phases, touches,
    label: force.label, felt: flat(force.felt), limit: flat(force.limit),
  };
}

export class Timeline {
  constructor(onseek) {
    this.label = made("span", { id: "force-label" });
    this.newtons = made("b", { id: "newtons" });
    this.limit = made("span", { id: "limit-label" }, "limit");
    this.legend = made("p", { class: "legend" }, this.label, " ", this.newtons, " ", this.limit);
    this.chart = made("div", { id: "chart" });
    this.phases = made("div", { id: "phases" });
    this.cursor = made("div", { id: "cursor" });
    this.range = made("input", {
      id: "time", type: "range", min: "0", max: "1", step: "any", value: "0", "aria-label": "Time",
    });
    this.range.addEventListener("input", () => onseek(Number(this.range.value)));
    this.element = made("div", { id: "timeline" }, this.chart, this.phases, this.cursor, this.range);
    this.width = 0;
    this.written = 0;
    new ResizeObserver(([{ contentRect }]) => (this.width = contentRect.width)).observe(this.element);
  }

  // `{end, times, felt, limit, label, phases, touches}`: times from 0 [s], forces [N].
  draw(lines) {
    this.lines = lines;
    const { end, label, limit, phases, touches } = lines;
    this.phases.replaceChildren(
      ...phases.map(({ phase, time }, i) => {
        const share = ((phases[i + 1]?.time ?? end) - time) / end;
        const name = phase.replaceAll("_", " ");
        const part = made("span", { class: "phase", "data-phase": phase, title: name }, share > SHORT ? name : "");
        part.style.flexGrow = String(share);
        return part;
      }),
      ...touches.map(({ time, bodies }) => {
        const tick = made("span", { class: "touch", title: bodies.join(" touches ") });
        tick.style.left = `${(100 * time) / end}%`;
        return tick;
      }),
    );
    this.chart.hidden = !label;
    this.label.textContent = label;
    this.limit.hidden = !limit.some((value) => value > 0);
    this.chart.replaceChildren(this.legend);
    if (label) forceChart(this.chart, lines);
    this.range.max = String(end);
  }

  // Shows a time [s] and the force then; figures change no more often than they can be read.
  show(time, newtons, { hurry = false } = {}) {
    const { end, phases } = this.lines;
    this.cursor.style.transform = `translateX(${((this.width * time) / end).toFixed(1)}px)`;
    if (hurry && performance.now() - this.written < READ) return false;
    this.written = performance.now();
    this.range.value = String(time);
    const phase = phases.findLast((each) => each.time <= time + 1e-6)?.phase ?? "";
    this.range.setAttribute("aria-valuetext", `${time.toFixed(1)} s, ${phase}`);
    this.newtons.textContent = `${newtons.toFixed(1)} N`;
    return true;
  }
}
