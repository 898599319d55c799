// Elements of the page, made without any text becoming markup.

// An element with attributes, listeners (`onclick`, …) and content: elements or text.
export function element(name, attributes = {}, ...content) {
  return filled(document.createElement(name), attributes, content);
}

// The same of a drawing.
export function drawing(name, attributes = {}, ...content) {
  return filled(document.createElementNS("http://www.w3.org/2000/svg", name), attributes, content);
}

function filled(made, attributes, content) {
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(key, value);
  }
  made.append(...content.flat().filter((each) => each !== null && each !== undefined));
  return made;
}

// A part of the page with its heading.
export function section(title, attributes = {}, ...content) {
  return element("section", { "aria-label": title, ...attributes }, element("h2", {}, title), ...content);
}
