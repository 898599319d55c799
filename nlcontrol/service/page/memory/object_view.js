// A small 3-D view of one object, apart from any table.

import { Vector3 } from "/viewer/vendor/three.module.min.js";
import { Viewer } from "/viewer/viewer.js";
import { element } from "../elements.js";

export class ObjectView {
  #viewer = null;

  // The element in which an object is seen, as its geometry has it.
  show(geometry, { name }) {
    this.#viewer?.dispose();
    const holder = element("div", { class: "object-view" });
    requestAnimationFrame(() => {
      if (!holder.isConnected) return;
      this.#viewer = new Viewer(holder, { ...geometry, floor: -0.001 });
      const tall = heightOf(geometry.bodies[0]);
      this.#viewer.canvas.setAttribute("aria-label", `The ${name} in 3-D. Arrow keys turn the view.`);
      this.#viewer.orbit.follow(new Vector3(0, 0, tall / 2), 0.22 + 1.9 * tall);
      this.#viewer.orbit.jump();
    });
    return holder;
  }
}

function heightOf({ shapes: [solid] }) {
  if (solid.kind === "box") return solid.size[2];
  if (solid.kind === "lathe") return Math.max(...solid.profile.map(([, z]) => z));
  return Math.max(...solid.corners.filter((_, i) => i % 3 === 2));
}
