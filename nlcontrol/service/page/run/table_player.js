// Who moves the bodies in the 3-D view: the frames of the session as they come, or a recording.

import { isUnderWay } from "../app_state.js";
import { LivePlayer, RecordingPlayer } from "/viewer/player.js";

// Dispatches `live` with the time [s] of what is shown, `recording` when one is, and `left` after it.
export class TablePlayer extends EventTarget {
  live = null; // player of the session's table
  shown = null; // `{player, scene, recording, story}` in the place of it
  #state;
  #api;
  #view;
  #table = null; // geometry of the session, while another table is shown
  #isAway = false; // true while another table is shown
  #end = () => {};

  constructor(state, api, view) {
    super();
    [this.#state, this.#api, this.#view] = [state, api, view];
    view.addEventListener("viewer", () => {
      if (!this.#isAway) this.#follow();
    });
    state.on(["run", "offer", "answer", "text"], () => {
      if (isUnderWay(state.get("run"))) this.leave();
    });
    state.on(["result"], () => {
      if (!state.get("result")) this.leave();
    });
  }

  // Takes the table of a session; a recording that is shown goes on being shown.
  take(geometry) {
    const { shown } = this;
    if (shown) {
      this.shown = null;
      this.dispatchEvent(new Event("left"));
    }
    this.#isAway = false;
    this.#view.show(geometry);
    if (shown) this.show(shown);
  }

  // Shows a recording from its end.
  show({ scene, recording, story }) {
    this.leave();
    if (!isOf(this.#view.viewer, scene)) {
      this.#table = this.#view.geometry;
      this.#isAway = true;
      this.#end();
      this.#view.show(scene);
    }
    const { viewer } = this.#view;
    this.live?.follow(null);
    const player = new RecordingPlayer(viewer, recording);
    viewer.setGhosts(story.ghosts);
    this.shown = { player, scene, recording, story };
    this.dispatchEvent(new Event("recording"));
    player.seek(player.end);
  }

  // Shows the table of the session again.
  leave() {
    if (!this.shown) return;
    this.shown = null;
    this.dispatchEvent(new Event("left"));
    const { viewer } = this.#view;
    viewer.setGhosts([]);
    viewer.setContacts([]);
    viewer.setLiquid([]);
    viewer.setFingers([]);
    const table = this.#isAway ? this.#table : null;
    this.#isAway = false;
    if (table) this.#view.show(table);
    else this.live?.take();
  }

  #follow() {
    this.#end();
    if (!this.#api.sessionId) return;
    this.live = new LivePlayer(this.#view.viewer);
    this.#view.viewer.orbit.jump();
    this.live.onshow((time) => this.dispatchEvent(new CustomEvent("live", { detail: { time } })));
    const { live } = this;
    this.#end = this.#api.live((frame) => {
      live.push(frame);
      this.#state.set({ pose: frame });
    });
  }
}

// True if a viewer draws the bodies of a scene.
function isOf(viewer, scene) {
  const names = (bodies) => bodies.map(({ name }) => name).join("\n");
  return Boolean(viewer) && names(viewer.document.bodies) === names(scene.bodies);
}
