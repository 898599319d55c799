// The curve of a force over time, and its limit.

const SVG = "http://www.w3.org/2000/svg";
const WIDE = 1000;
const HIGH = 100;

export function forceChart(holder, { times, felt, limit, end }) {
  const most = Math.max(...felt, ...limit, 0.5) * 1.4; // room for the legend
  const x = (time) => ((time / end) * WIDE).toFixed(1);
  const y = (force) => (HIGH - (Math.max(force, 0) / most) * HIGH).toFixed(1);
  const svg = drawn("svg", { viewBox: `0 0 ${WIDE} ${HIGH}`, preserveAspectRatio: "none", "aria-hidden": "true" });
  const line = felt.map((force, i) => `${x(times[i])},${y(force)}`).join(" ");
  const last = x(times[times.length - 1]);
  svg.append(
    drawn("polygon", { class: "area", points: `0,${HIGH} ${line} ${last},${HIGH}` }),
    drawn("polyline", { class: "felt", points: line }),
  );
  for (const stretch of stretches(limit)) {
    const points = stretch.map((i) => `${x(times[i])},${y(limit[i])}`).join(" ");
    svg.append(drawn("polyline", { class: "limit", points }));
  }
  holder.append(svg);
}

// Runs of frames in which a limit is in force.
function stretches(limit) {
  const found = [];
  limit.forEach((value, i) => {
    if (value <= 0) return;
    if (i > 0 && limit[i - 1] > 0) found[found.length - 1].push(i);
    else found.push([i]);
  });
  return found;
}

function drawn(name, attributes) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
}
