// What becomes of a call that failed: a state of the connection, which heals, or a problem to be read.

import { isGivenUp } from "./service_api.js";

const CONNECTIONS = {
  no_answer: "no_answer", unknown_session: "no_session", session_lost: "no_session", too_many_sessions: "full",
};

export function tellProblem(state, problem) {
  if (isGivenUp(problem)) return;
  const connection = CONNECTIONS[problem.code];
  state.set(connection ? { connection } : { problem });
}

// The line in which a problem stands until it is closed, or the next sentence is said.
export function showProblems(state, line, text, close) {
  close.addEventListener("click", () => state.set({ problem: null }));
  state.on(["problem"], () => {
    const problem = state.get("problem");
    line.hidden = !problem;
    const { detail = String(problem), suggestions = [] } = problem ?? {};
    text.textContent = problem ? [detail, ...suggestions].join(" – ") : "";
  });
}
