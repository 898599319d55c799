// Texts beside places of the 3-D view, kept apart from each other.

import { element } from "../elements.js";

const BESIDE = 12; // from the place to the text [px]
const APART = 25; // from one text to the next [px]

export class ViewLabels {
  #layer = element("div", { class: "view-labels", "aria-hidden": "true" });
  #labels = [];

  constructor(viewer) {
    this.viewer = viewer;
    viewer.holder.append(this.#layer);
    viewer.scene.onAfterRender = () => this.#place();
  }

  // Each label has a `text`, what it is `about`, and `places` in W; it stands right of all of them,
  // or left of them if its `side` is "left" or there is no room.
  show(labels) {
    this.#labels = labels.map(({ text, about, places, side }) => {
      const made = element("span", { class: "view-label", "data-about": about }, text);
      return { made, places, side, width: 0 };
    });
    this.#layer.replaceChildren(...this.#labels.map(({ made }) => made));
    for (const label of this.#labels) label.width = label.made.offsetWidth;
  }

  remove() {
    this.viewer.scene.onAfterRender = () => {};
    this.#layer.remove();
  }

  #place() {
    const [width, height] = this.viewer.size;
    const seen = [];
    for (const label of this.#labels) {
      const spots = label.places.map((place) => this.viewer.project(place)).filter(Boolean);
      label.made.hidden = !spots.length;
      if (!spots.length) continue;
      const right = spots.reduce((a, b) => (b[0] > a[0] ? b : a));
      const left = spots.reduce((a, b) => (b[0] < a[0] ? b : a));
      const fits = label.side !== "left" && right[0] + BESIDE + label.width < width;
      const [x, y] = fits ? [right[0] + BESIDE, right[1]] : [left[0] - BESIDE - label.width, left[1]];
      seen.push({ label, x: Math.max(4, x), y });
    }
    seen.sort((a, b) => a.y - b.y);
    let before = -Infinity;
    for (const { label, x, y } of seen) {
      before = Math.min(Math.max(y, before + APART, 14), height - 14);
      label.made.style.transform = `translate(${Math.round(x)}px, ${Math.round(before - 12)}px)`;
    }
  }
}
