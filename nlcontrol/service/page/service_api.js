// Calls of the service, one method for each route. A refused call rejects with its problem document,
// one that got no answer with a document of its own (`no_answer`);
// an older call of the same kind is given up, and rejects with an `AbortError`.

export const EVENT_KINDS = [
  "understood", "planned", "phase", "contact", "force", "replanned", "lesson", "verdict", "ended",
];

const GRACE = 5; // for which a session that was given back waits for a reload [s]
const NO_ANSWER = { code: "no_answer", detail: "The service does not answer." };
const GATEWAYS = new Set([502, 503, 504]); // of a proxy, before a service that does not answer

export class ServiceApi {
  sessionId = null; // in which sentences are said
  table = {}; // scene and seed of that session
  onGap = () => {}; // called when a stream is cut off
  #underWay = new Map(); // what gives up a call, by its kind

  // -- the host -----------------------------------------------------------------------------------

  logIn = (secret) => this.#call("login", "POST", "/login", { secret });
  openapi = () => this.#call("openapi", "GET", "/openapi.json");
  health = () => this.#call("health", "GET", "/health");
  scenes = () => this.#call("scenes", "GET", "/scenes");
  objects = () => this.#call("objects", "GET", "/objects");
  object = (name) => this.#call("object", "GET", `/objects/${encodeURIComponent(name)}`);

  // -- a session ----------------------------------------------------------------------------------

  openSession = (spec) => this.#call("open", "POST", "/sessions", spec);

  // Says further sentences in a session.
  enter({ session_id: id, spec: { scene, seed } }) {
    this.sessionId = id;
    this.table = { scene, seed };
  }

  // Says nothing further there.
  forget() {
    this.sessionId = null;
  }

  // Gives the session back when the page goes, which may be a reload: it ends unless it is taken up
  // again, or something is carried out in it.
  giveBack() {
    if (!this.sessionId) return;
    const path = `/v1/sessions/${this.sessionId}?idle=${GRACE}`;
    fetch(path, { method: "DELETE", keepalive: true }).catch(() => {});
  }

  session = (id = this.sessionId) => this.#call("session", "GET", `/sessions/${id}`);
  closeSession = (id = this.sessionId) => this.#call("close", "DELETE", `/sessions/${id}`);
  geometry = () => this.#call("geometry", "GET", this.#path("geometry"));
  look = () => this.#call("look", "POST", this.#path("look"));
  reset = () => this.#call("reset", "POST", this.#path("reset"));
  ask = (text) => this.#call("ask", "POST", this.#path("ask"), { text, explain: true });
  plan = (text) => this.#call("plan", "POST", this.#path("plans"), { text, explain: true });
  // Reading needs the names of the table alone, and need not wait for what the session does.
  parse = (text, table = this.table) => this.#call("parse", "POST", "/parse", { text, table });
  predict = (push) => this.#call("predict", "POST", this.#path("predict"), push);
  map = (face) => this.#call("map", "POST", this.#path("map"), face);
  affordances = (object, table) => this.#call("affordances", "POST", "/affordances", { object, table });

  // -- runs ---------------------------------------------------------------------------------------

  // The plan of a sentence; under any other the service refuses it.
  execute = (planId, text) => this.#begin("runs", { plan_id: planId, text });
  say = (text) => this.#begin("say", { text });
  run = (id) => this.#call(`run ${id}`, "GET", `/runs/${id}`);
  runs = (search = {}) => this.#call("runs", "GET", `/runs?${new URLSearchParams(search)}`);
  stop = (id) => this.#call("stop", "POST", `/runs/${id}/stop`);
  abort = (id) => this.#call("abort", "POST", `/runs/${id}/abort`);
  deleteRun = (id) => this.#call(`delete ${id}`, "DELETE", `/runs/${id}`);
  recording = (id) => this.#call("recording", "GET", `/runs/${id}/recording`);
  fileOf = (id, kind) => `/v1/runs/${id}/${kind}`; // "bundle", "replay", "trace"

  // -- streams ------------------------------------------------------------------------------------

  // Events of a run that follow a number; goes on by itself after a gap. Calls `onEnd` when no
  // further one comes. Returns what ends it.
  events(id, after, onEvent, onEnd = () => {}) {
    const source = new EventSource(`/v1/runs/${id}/events?after=${after}`);
    for (const kind of EVENT_KINDS) {
      source.addEventListener(kind, ({ data }) => {
        if (kind === "ended") source.close();
        onEvent(JSON.parse(data));
        if (kind === "ended") onEnd();
      });
    }
    source.addEventListener("error", () => {
      this.onGap();
      if (source.readyState === EventSource.CLOSED) onEnd();
    });
    return () => source.close();
  }

  // Frames of a session for a viewer, until what is returned is called.
  live(onFrame, id = this.sessionId) {
    const source = new EventSource(`/v1/sessions/${id}/live`);
    source.addEventListener("poses", ({ data }) => onFrame(JSON.parse(data)));
    source.addEventListener("error", () => this.onGap());
    return () => source.close();
  }

  // -- calls --------------------------------------------------------------------------------------

  #path(what) {
    return `/sessions/${this.sessionId}/${what}`;
  }

  // Begins a run; the same request is not begun twice, should it be sent again.
  #begin(what, body) {
    const headers = { "Idempotency-Key": crypto.getRandomValues(new Uint32Array(4)).join("-") };
    return this.#call("begin", "POST", this.#path(what), body, headers);
  }

  async #call(kind, method, path, body, headers = {}) {
    this.#underWay.get(kind)?.abort();
    const given = new AbortController();
    this.#underWay.set(kind, given);
    const options = { method, headers: { ...headers }, signal: given.signal };
    if (body !== undefined) {
      options.headers["Content-Type"] = "application/json";
      options.body = JSON.stringify(body);
    }
    let [response, text] = [];
    try {
      response = await fetch(`/v1${path}`, options);
      text = await response.text();
    } catch (problem) {
      throw isGivenUp(problem) ? problem : NO_ANSWER;
    }
    if (GATEWAYS.has(response.status)) throw NO_ANSWER;
    const document = text ? JSON.parse(text) : null;
    if (!response.ok) throw document;
    return document;
  }
}

// True if a call was given up for a newer one of its kind.
export function isGivenUp(problem) {
  return problem?.name === "AbortError";
}
