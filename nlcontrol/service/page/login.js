// The login at a service that has a token: by the link that it has printed, or with the token.

import { element, section } from "./elements.js";

// Uses the code behind the `#` of such a link, and takes it out of the address.
export async function logInByLink(api) {
  const code = new URLSearchParams(location.hash.slice(1)).get("login");
  if (!code) return;
  history.replaceState(null, "", location.pathname + location.search);
  await api.logIn(code).catch(() => {}); // a code that is used up may have given its cookie already
}

// The field of the token, in the place of all that the page cannot show without it.
export function loginForm(api) {
  const told = element("p", { role: "alert" });
  const field = element("input", {
    type: "password", name: "token", autocomplete: "current-password", required: true, "aria-label": "Token",
  });
  const form = element("form", {}, field, element("button", { class: "primary" }, "Log in"));
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    try {
      await api.logIn(field.value);
      location.reload();
    } catch (problem) {
      told.textContent = problem.detail ?? String(problem);
    }
  });
  return section("Log in", { id: "login" },
    element("p", {}, "This service needs its token. The link that it printed also logs you in."), form, told);
}
