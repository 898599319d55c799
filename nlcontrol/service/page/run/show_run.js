// A run that is looked at again: all that the page shows becomes that of the run.

import { isUnderWay } from "../app_state.js";
import { readAgain } from "../sentence/sentence_reading.js";

// Shows a run; another one that is under way goes on and stays where it is.
export function showRun(state, api, run) {
  if (isUnderWay(state.get("run"))) return;
  state.begin({ text: run.text, said: run.text, run, result: run.result });
  readAgain(state, api, run);
}
