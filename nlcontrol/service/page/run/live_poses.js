// Everything in the 3-D view where it is now.

import { LivePlayer } from "/viewer/player.js";

// Lets each viewer of the table follow the frames of the session.
export function followLivePoses(state, api, view) {
  let end = () => {};
  view.addEventListener("viewer", () => {
    end();
    const player = new LivePlayer(view.viewer);
    end = api.live((frame) => {
      player.push(frame);
      state.set({ pose: frame });
    });
  });
}
