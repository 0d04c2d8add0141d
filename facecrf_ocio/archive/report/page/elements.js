// Everything of the archive reaches the page as text (textContent, attributes), never as markup.
const byId = (id) => document.getElementById(id);
const load = (id) => JSON.parse(byId(id).textContent);
const DATA = load("data");
const C = DATA.columns;
const N = C.name.length;
const word = (column, row) => DATA.words[C[column][row]];
const plural = (n, one, many) => `${count(n)} ${n === 1 ? one : many || one + "s"}`;
const numbers = new Intl.NumberFormat("en");
const count = (n) => numbers.format(n);
// As people order names: EOS 5D before EOS 10D.
const inOrder = new Intl.Collator("en", {numeric: true}).compare;
const percent = (n) => {
  const share = (100 * n) / Math.max(N, 1);
  return n && share < 0.1 ? "< 0.1 %" : `${share.toFixed(share < 10 && share > 0 ? 1 : 0)} %`;
};

// Line ends, other controls and marks that turn the direction of writing are shown as escapes.
const STEERING = /[\u0000-\u001f\u007f-\u009f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]/g;
const visible = (text) =>
  text.replace(
    STEERING,
    (c) =>
      ({"\n": "\\n", "\r": "\\r", "\t": "\\t"})[c] ||
      "\\u" + c.charCodeAt(0).toString(16).padStart(4, "0"),
  );

function fill(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes || {})) {
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (value !== null && value !== false)
      node.setAttribute(name, value === true ? "" : value);
  }
  node.append(...children.filter((child) => child !== null));
  return node;
}
const el = (tag, attributes, ...children) =>
  fill(document.createElement(tag), attributes, children);
const svg = (tag, attributes, ...children) =>
  fill(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);
// A filter of colors, to be named by its id in a style.
const pixelFilter = (id, ...parts) =>
  svg(
    "svg",
    {class: "filter", width: 0, height: 0, "aria-hidden": "true"},
    svg(
      "filter",
      {id, "color-interpolation-filters": "sRGB", x: 0, y: 0, width: 1, height: 1},
      ...parts,
    ),
  );
// Red, green and blue each looked up in a table of their own.
const byTables = (tables) =>
  svg(
    "feComponentTransfer",
    {},
    ...["R", "G", "B"].map((c, i) => svg(`feFunc${c}`, {type: "table", tableValues: tables[i]})),
  );
// Text of ours, in which what a user types stands between backticks.
const typed = (text) => text.split("`").map((part, i) => (i % 2 ? el("code", {}, part) : part));
// A table's row whose cells know their headings, which a phone shows beside them.
function titled(row, titles) {
  [...row.children].forEach((cell, i) => cell.setAttribute("data-title", titles[i]));
  return row;
}
