// The page: puts its parts together, and opens a session.

import { followAddress } from "./address.js";
import { AppState } from "./app_state.js";
import { loginForm, logInByLink } from "./login.js";
import { historyPanel } from "./memory/history_panel.js";
import { libraryPanel } from "./memory/library_panel.js";
import { approvalPanel } from "./prediction/approval_panel.js";
import { predictionPanel } from "./prediction/prediction_panel.js";
import { showProblems, tellProblem } from "./problems.js";
import { runPanel } from "./run/run_panel.js";
import { TablePlayer } from "./run/table_player.js";
import { timelinePanel } from "./run/timeline_panel.js";
import { answerPanel } from "./sentence/answer_panel.js";
import { examplesPanel } from "./sentence/examples.js";
import { sentencePanel } from "./sentence/sentence_panel.js";
import { tablePicker } from "./sentence/table_picker.js";
import { parametersPanel, understandingPanel } from "./sentence/understanding_panel.js";
import { ServiceApi } from "./service_api.js";
import { sessionKeeper } from "./session_keeper.js";
import { TableSpace } from "./table_space.js";

const $ = (id) => document.getElementById(id);

async function showTable(state, api, view, player) {
  const id = state.get("session")?.session_id;
  if (!id || id === view.of) return;
  view.of = id;
  try {
    player.take(await api.geometry());
  } catch (problem) {
    tellProblem(state, problem);
  }
}

async function start() {
  const state = new AppState();
  const api = new ServiceApi();
  const view = new TableSpace($("view"));
  const player = new TablePlayer(state, api, view);
  $("top").append(tablePicker(state, api), sentencePanel(state, api));
  $("below").append(approvalPanel(state, api), timelinePanel(state, api, view, player));
  $("story").append(
    runPanel(state, api), examplesPanel(state, api), understandingPanel(state, api),
    answerPanel(state), predictionPanel(state, api, view), parametersPanel(state),
    historyPanel(state, api), libraryPanel(state, api, view),
  );
  $("notices").prepend(sessionKeeper(state, api));
  const line = $("problem");
  showProblems(state, line, line.querySelector("span"), line.querySelector("button"));
  state.on(["session"], () => showTable(state, api, view, player));
  globalThis.page = { state, api, view }; // for whoever looks into it
  try {
    await logInByLink(api);
    const [{ scenes }, { objects }] = await Promise.all([api.scenes(), api.objects()]);
    state.set({ scenes, objects });
    await followAddress(state, api);
    state.set({ ready: true });
  } catch (problem) {
    if (problem.code === "wrong_token") $("story").replaceChildren(loginForm(api));
    else tellProblem(state, problem);
  }
  document.documentElement.dataset.ready = "true";
}

start();
