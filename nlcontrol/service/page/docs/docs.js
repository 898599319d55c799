// The OpenAPI document as a page, by Swagger UI. All that it loads comes from this service.

import { loginForm } from "../login.js";
import { ServiceApi } from "../service_api.js";

const place = document.getElementById("document");

// Descriptions without markup, as the page's policy lets no text become any; words between
// backticks are code.
function plainDescriptions({ React }) {
  const told = ({ source }) => React.createElement("p", { className: "told" }, ...codeApart(React, source ?? ""));
  return { wrapComponents: { Markdown: () => told } };
}

function codeApart(React, text) {
  return text.split("`").map((part, place) => (place % 2 ? React.createElement("code", {}, part) : part));
}

async function show() {
  const api = new ServiceApi();
  try {
    const spec = await api.openapi();
    globalThis.SwaggerUIBundle({
      spec, domNode: place, plugins: [plainDescriptions], deepLinking: true, docExpansion: "list",
      defaultModelsExpandDepth: 0, validatorUrl: null, onComplete: tellReady,
    });
  } catch (problem) {
    if (problem.code === "wrong_token") place.replaceChildren(loginForm(api));
    else place.textContent = problem.detail ?? String(problem);
    tellReady();
  }
}

function tellReady() {
  document.documentElement.dataset.ready = "true";
}

show();
