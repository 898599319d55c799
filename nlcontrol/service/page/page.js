// The page: puts its parts together, and opens a session.

import { AppState } from "./app_state.js";
import { loginForm, logInByLink } from "./login.js";
import { historyPanel } from "./memory/history_panel.js";
import { libraryPanel } from "./memory/library_panel.js";
import { takeUpSession } from "./open_session.js";
import { approvalPanel } from "./prediction/approval_panel.js";
import { predictionPanel } from "./prediction/prediction_panel.js";
import { runPanel } from "./run/run_panel.js";
import { TablePlayer } from "./run/table_player.js";
import { timelinePanel } from "./run/timeline_panel.js";
import { answerPanel } from "./sentence/answer_panel.js";
import { examplesPanel } from "./sentence/examples.js";
import { sentencePanel } from "./sentence/sentence_panel.js";
import { saySentence } from "./sentence/sentence_reading.js";
import { tablePicker } from "./sentence/table_picker.js";
import { parametersPanel, understandingPanel } from "./sentence/understanding_panel.js";
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
  if (!problem) return;
  const lost = problem instanceof TypeError; // of a request that got no answer
  const { detail = lost ? "The service does not answer." : String(problem), suggestions = [] } = problem;
  $("problem").textContent = [detail, ...suggestions].join(" – ");
}

// What a link asks for: a sentence to be planned, a scene and a seed.
function linkedTable() {
  const { seed, ...words } = Object.fromEntries(new URLSearchParams(location.search));
  const found = { say: words.say, scene: words.scene, seed: seed === undefined ? seed : Number(seed) };
  return Object.fromEntries(Object.entries(found).filter(([, value]) => value !== undefined));
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
  state.on(["problem"], tellProblem);
  state.on(["session"], () => showTable(state, api, view));
  globalThis.page = { state, api, view }; // for whoever looks into it
  try {
    await logInByLink(api);
    const [{ scenes }, { objects }] = await Promise.all([api.scenes(), api.objects()]);
    state.set({ scenes, objects });
    const { say, ...table } = linkedTable();
    await takeUpSession(state, api, table);
    if (say && !state.get("run")) saySentence(state, api, say);
  } catch (problem) {
    if (problem.code === "wrong_token") $("story").replaceChildren(loginForm(api));
    else state.set({ problem });
  }
  document.documentElement.dataset.ready = "true";
}

start();
