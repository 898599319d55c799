// The 3-D view of the session's table; each table has a viewer of its own, in the same place.

import { Viewer } from "/viewer/viewer.js";

// Dispatches `viewer` when there is another viewer: what was drawn in the one before is gone.
export class TableSpace extends EventTarget {
  viewer = null;
  geometry = null; // that is drawn
  of = null; // id of the session whose table it is
  #holder;

  constructor(holder) {
    super();
    this.#holder = holder;
  }

  // Draws a table anew, from its SceneGeometry.
  show(geometry) {
    this.viewer?.dispose();
    this.geometry = geometry;
    this.viewer = new Viewer(this.#holder, geometry);
    this.dispatchEvent(new Event("viewer"));
  }
}
