// The page: puts its parts together, and opens a session.

import { AppState } from "./app_state.js";
import { historyPanel } from "./memory/history_panel.js";
import { libraryPanel } from "./memory/library_panel.js";
import { takeUpSession } from "./open_session.js";
import { predictionPanel } from "./prediction/prediction_panel.js";
import { followLivePoses } from "./run/live_poses.js";
import { runPanel } from "./run/run_panel.js";
import { timelinePanel } from "./run/timeline_panel.js";
import { sentencePanel } from "./sentence/sentence_panel.js";
import { ServiceApi, isGivenUp } from "./service_api.js";
import { TableSpace } from "./table_space.js";

const $ = (id) => document.getElementById(id);

async function showTable(state, api, view) {
  const id = state.get("session")?.session_id;
  if (!id || id === view.of) return;
  view.of = id;
  try {
    view.show(await api.geometry());
  } catch (problem) {
    if (!isGivenUp(problem)) state.set({ problem });
  }
}

function tellProblem(state) {
  const problem = state.get("problem");
  $("problem").hidden = !problem;
  const { detail, suggestions = [] } = problem ?? {};
  $("problem").textContent = problem ? [detail ?? String(problem), ...suggestions].join(" – ") : "";
}

async function start() {
  const state = new AppState();
  const api = new ServiceApi();
  const view = new TableSpace($("view"));
  $("top").append(sentencePanel(state, api));
  $("below").append(timelinePanel(state, api, view));
  $("story").append(
    predictionPanel(state, api, view), runPanel(state, api, view),
    historyPanel(state, api, view), libraryPanel(state, api, view),
  );
  followLivePoses(state, api, view);
  state.on(["problem"], tellProblem);
  state.on(["session"], () => showTable(state, api, view));
  globalThis.page = { state, api, view }; // for whoever looks into it
  try {
    const [{ scenes }, { objects }] = await Promise.all([api.scenes(), api.objects()]);
    state.set({ scenes, objects });
    await takeUpSession(state, api);
  } catch (problem) {
    state.set({ problem });
  }
  document.documentElement.dataset.ready = "true";
}

start();
