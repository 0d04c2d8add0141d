"use strict";
// Everything of the archive reaches the page as text (textContent, attributes), never as markup.
(() => {
const byId = (id) => document.getElementById(id);
const load = (id) => JSON.parse(byId(id).textContent);
const DATA = load("data");
const C = DATA.columns;
const N = C.name.length;
const word = (column, row) => DATA.words[C[column][row]];
const plural = (n, one, many) => `${count(n)} ${n === 1 ? one : many || one + "s"}`;
const numbers = new Intl.NumberFormat("en");
const count = (n) => numbers.format(n);
const percent = (n) => {
  const share = 100 * n / Math.max(N, 1);
  return n && share < 0.1 ? "< 0.1 %" : `${share.toFixed(share < 10 && share > 0 ? 1 : 0)} %`;
};

// Line ends, other controls and marks that turn the direction of writing are shown as escapes.
const STEERING = /[\u0000-\u001f\u007f-\u009f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]/g;
const visible = (text) => text.replace(STEERING, (c) =>
  ({"\n": "\\n", "\r": "\\r", "\t": "\\t"})[c] || "\\u" + c.charCodeAt(0).toString(16).padStart(4, "0"));

function fill(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes || {})) {
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (value !== null && value !== false) node.setAttribute(name, value === true ? "" : value);
  }
  node.append(...children.filter((child) => child !== null));
  return node;
}
const el = (tag, attributes, ...children) => fill(document.createElement(tag), attributes, children);
const svg = (tag, attributes, ...children) =>
  fill(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);

// ---- curves ----
let curveTexts = null;
const curveCache = new Map();
function curveOf(index) {
  if (index < 0) return null;
  if (!curveTexts) curveTexts = load("curves");
  if (!curveCache.has(index)) {
    const bytes = Uint8Array.from(atob(curveTexts[index]), (c) => c.charCodeAt(0));
    const view = new DataView(bytes.buffer);
    const values = Array.from({length: bytes.length / 2}, (_, i) => view.getUint16(2 * i, true) / 65535);
    const samples = DATA.srgb.length;
    const channels = [];
    for (let at = 0; at < values.length; at += 2 * samples) {
      channels.push({linear: values.slice(at, at + samples), half: values.slice(at + samples, at + 2 * samples)});
    }
    curveCache.set(index, channels);
  }
  return curveCache.get(index);
}

function told(channels) {
  const names = channels.length === 1 ? [""] : ["red ", "green ", "blue "];
  const middle = (DATA.srgb.length - 1) / 2;
  const parts = channels.map(({linear, half}, i) =>
    `${names[i]}${(100 * linear[middle]).toFixed(0)} % give or take ${(100 * half[middle]).toFixed(0)}`);
  return `Curve: the middle code value is ${parts.join(", ")} of white; sRGB would be 21 %`;
}

function plot(index, width, height, label) {
  const channels = curveOf(index);
  const large = width > 200;
  const [left, bottom, edge] = large ? [44, 40, 8] : [1, 1, 1];
  const x = (u) => (left + u * (width - left - edge)).toFixed(1);
  const y = (v) => (edge + (1 - Math.min(Math.max(v, 0), 1)) * (height - bottom - edge)).toFixed(1);
  const u = (i) => i / (DATA.srgb.length - 1);
  const path = (values) => values.map((v, i) => `${i ? "L" : "M"}${x(u(i))} ${y(v)}`).join("");
  const picture = svg("svg", {class: "plot", width, height, viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": label || told(channels)});
  if (large) {
    for (const tick of [0, 0.25, 0.5, 0.75, 1]) {
      picture.append(
        svg("line", {class: "grid", x1: x(tick), x2: x(tick), y1: y(0), y2: y(1)}),
        svg("line", {class: "grid", x1: x(0), x2: x(1), y1: y(tick), y2: y(tick)}),
        svg("text", {x: x(tick), y: height - 24, "text-anchor": "middle"}, String(tick)),
        svg("text", {x: left - 6, y: +y(tick) + 4, "text-anchor": "end"}, String(tick)));
    }
    const half = +y(0.5);
    picture.append(
      svg("text", {x: x(0.5), y: height - 5, "text-anchor": "middle"}, "code value"),
      svg("text", {x: 11, y: half, "text-anchor": "middle", transform: `rotate(-90 11 ${half})`}, "relative linear light"));
  } else {
    picture.append(svg("rect", {class: "frame", x: 0.5, y: 0.5, width: width - 1, height: height - 1}));
  }
  const color = (kind, i) => (channels.length === 1 ? "" : ` ${kind}${"rgb"[i]}`);
  channels.forEach(({linear, half}, i) => {
    if (!half.some((h) => h > 0)) return;
    const up = path(linear.map((v, k) => v + half[k]));
    const down = linear.map((v, k) => `L${x(u(k))} ${y(v - half[k])}`).reverse().join("");
    picture.append(svg("path", {class: `area${color("a", i)}`, d: `${up}${down}Z`}));
  });
  picture.append(svg("path", {class: "reference", d: path(DATA.srgb)}));
  channels.forEach(({linear}, i) => picture.append(svg("path", {class: `line${color("c", i)}`, d: path(linear)})));
  return picture;
}

// ---- pictures ----
const blocks = new Map();
function pictureOf(row) {
  const at = C.picture[row];
  if (at < 0) return ["", ""];
  const number = Math.floor(at / DATA.block);
  if (!blocks.has(number)) {
    if (blocks.size > 40) blocks.clear();
    blocks.set(number, load(`pictures-${number}`));
  }
  return blocks.get(number)[at % DATA.block];
}
const webp = (text, alt, scale) => {
  const image = el("img", {alt, decoding: "async"});
  if (scale) image.addEventListener("load", () => { image.width = scale * image.naturalWidth; });
  image.src = `data:image/webp;base64,${text}`;
  return image;
};
function whyNoPicture(row) {
  const missing = word("missing", row);
  if (missing) return missing;
  return C.picture[row] < 0 ? "Left out: too many photos for one page." : "";
}

// ---- what the rows say ----
// "NIKON CORPORATION" of "NIKON D70" need not be said twice.
const firstWord = (text) => text.toLowerCase().split(" ")[0];
const cameraName = (make, model) =>
  visible(firstWord(model) === firstWord(make) ? model : `${make} ${model}`.trim());
const cameraOf = (row) => cameraName(word("make", row), word("model", row));
const kindName = (kind) => DATA.kinds[kind];
const verdict = (kind) => el("span", {class: `verdict k${kind}`}, kindName(kind));
const counts = DATA.kinds.map(() => 0);
let duplicates = 0, misfits = 0, inBrackets = 0, pictureless = 0, seconds = 0, withCurve = 0;
const cameras = new Map();
for (let row = 0; row < N; row++) {
  counts[C.kind[row]]++;
  seconds += C.seconds[row];
  if (word("whose", row)) withCurve++;
  if (word("duplicateOf", row)) duplicates++;
  if (C.misfit[row]) misfits++;
  if (word("bracket", row)) inBrackets++;
  if (word("missing", row)) pictureless++;
  const name = cameraOf(row);
  if (!cameras.has(name)) cameras.set(name, DATA.kinds.map(() => 0));
  cameras.get(name)[C.kind[row]]++;
}

// ---- state, filters, order ----
const state = {search: [], kind: -1, camera: null, mark: "", only: null, sort: "name", down: false, page: 0, per: 50};
const MARKS = {
  misfit: ["does not fit its camera", misfits, (row) => C.misfit[row]],
  bracket: ["in a bracket", inBrackets, (row) => word("bracket", row)],
  duplicate: ["duplicate", duplicates, (row) => word("duplicateOf", row)],
  pictureless: ["without a picture", pictureless, (row) => word("missing", row)],
};
let haystacks = null;
function haystack(row) {
  if (!haystacks) {
    haystacks = Array.from({length: N}, (_, i) => [C.name[i], cameraOf(i), word("serial", i), word("software", i),
      word("outcome", i), kindName(C.kind[i]), word("estimator", i), word("reason", i), word("remedy", i)].join("\n").toLowerCase());
  }
  return haystacks[row];
}
const KEYS = {
  name: null, // rows come in this order
  kind: (row) => C.kind[row],
  band: (row) => (C.band[row] < 0 ? null : C.band[row]),
  camera: (row) => cameraOf(row) || null,
  reason: (row) => word("reason", row) || null,
};
let found = [];
function choose() {
  found = [];
  const mark = state.mark ? MARKS[state.mark][2] : null;
  for (let row = 0; row < N; row++) {
    if (state.kind >= 0 && C.kind[row] !== state.kind) continue;
    if (state.camera !== null && cameraOf(row) !== state.camera) continue;
    if (mark && !mark(row)) continue;
    if (state.only && !state.only.test(row)) continue;
    if (state.search.length && !state.search.every((part) => haystack(row).includes(part))) continue;
    found.push(row);
  }
  const key = KEYS[state.sort];
  const sign = state.down ? -1 : 1;
  if (!key) {
    if (state.down) found.reverse();
  } else {
    const keys = new Map(found.map((row) => [row, key(row)]));
    found.sort((a, b) => {
      const [p, q] = [keys.get(a), keys.get(b)];
      if (p === q) return a - b;
      if (p === null || q === null) return p === null ? 1 : -1; // what says nothing comes last
      return (p < q ? -1 : 1) * sign;
    });
  }
}

// ---- the table ----
const COLUMNS = [
  ["Before, after", null, ""], ["Photo", "name", ""], ["Verdict", "kind", ""], ["Curve", null, ""],
  ["Band [%]", "band", "number"], ["Camera", "camera", ""], ["Reason", "reason", ""],
];
function drawHead() {
  byId("head").replaceChildren(...COLUMNS.map(([title, key, kind]) => {
    if (!key) return el("th", {scope: "col", class: kind}, title);
    const arrow = el("span", {class: "arrow", "aria-hidden": "true"}, "↕");
    const heading = el("th", {scope: "col", class: kind, "data-key": key});
    heading.append(el("button", {type: "button", onclick: () => {
      state.down = state.sort === key ? !state.down : false;
      state.sort = key;
      state.page = 0;
      update();
    }}, title, arrow));
    return heading;
  }));
}
function markSort() {
  for (const heading of byId("head").querySelectorAll("[data-key]")) {
    const active = heading.dataset.key === state.sort;
    if (active) heading.setAttribute("aria-sort", state.down ? "descending" : "ascending");
    else heading.removeAttribute("aria-sort");
    heading.querySelector(".arrow").textContent = active ? (state.down ? "▼" : "▲") : "↕";
  }
}
function pairCell(row) {
  const [before, after] = pictureOf(row);
  const name = visible(C.name[row]);
  const why = whyNoPicture(row);
  if (!before && !after) return el("td", {}, el("p", {class: "absent"}, why || "No picture."));
  return el("td", {},
    el("div", {class: "pair"},
      before ? webp(before, `${name}, as encoded`) : null,
      after ? webp(after, `${name}, linearized`) : null),
    why ? el("p", {class: "absent"}, why) : null);
}
function marks(row) {
  const all = [];
  if (C.misfit[row]) all.push(el("li", {class: "misfit"}, `does not fit its camera: ${C.misfit[row]} s.d.`));
  if (word("whose", row) === "camera") all.push(el("li", {}, "curve of its camera"));
  if (word("whose", row) === "bracket") all.push(el("li", {}, "curve of its bracket"));
  else if (word("bracket", row)) all.push(el("li", {}, "in a bracket"));
  if (word("duplicateOf", row)) all.push(el("li", {}, `same as ${visible(word("duplicateOf", row))}`));
  return all.length ? el("ul", {class: "marks", "aria-label": "Marks"}, ...all) : null;
}
function reasonNodes(row) {
  const [reason, remedy] = [visible(word("reason", row)), visible(word("remedy", row))];
  return [reason, remedy ? el("span", {class: "remedy"}, `; ${remedy}`) : null];
}
function tableRow(row, position) {
  const curve = C.curve[row];
  const band = C.band[row];
  return el("tr", {"aria-rowindex": position + 2},
    pairCell(row),
    el("th", {scope: "row"},
      el("button", {type: "button", class: "link", "aria-haspopup": "dialog", onclick: () => show(row)}, visible(C.name[row])),
      marks(row)),
    el("td", {}, verdict(C.kind[row])),
    el("td", {}, curve < 0 ? el("span", {class: "dim"}, "none") : plot(curve, 96, 72)),
    el("td", {class: "number"}, band < 0 ? "–" : `± ${band.toFixed(1)}`),
    el("td", {class: "camera"}, cameraOf(row) || el("span", {class: "dim"}, "unknown")),
    el("td", {class: "reason"}, ...reasonNodes(row)));
}
function pages() { return Math.max(Math.ceil(found.length / state.per), 1); }
function drawPagers() {
  for (const pager of document.querySelectorAll(".pager")) {
    if (!pager.childElementCount) {
      const lower = pager.getAttribute("aria-label").includes("below");
      const step = (name, sign, to) => el("button", {type: "button", "data-step": name, "aria-label": `${name} page`, onclick: (event) => {
        if (event.currentTarget.getAttribute("aria-disabled") === "true") return;
        state.page = to();
        draw();
        if (lower) document.querySelector(".scroll").focus();
      }}, sign);
      pager.append(
        step("First", "«", () => 0), step("Previous", "‹", () => state.page - 1), el("span", {}),
        step("Next", "›", () => state.page + 1), step("Last", "»", () => pages() - 1));
    }
    pager.querySelector("span").textContent = `Page ${count(state.page + 1)} of ${count(pages())}`;
    for (const button of pager.querySelectorAll("button")) {
      const ended = ["First", "Previous"].includes(button.dataset.step) ? state.page === 0 : state.page >= pages() - 1;
      button.setAttribute("aria-disabled", String(ended));
    }
  }
}
function draw() {
  const begin = state.page * state.per;
  const rows = found.slice(begin, begin + state.per);
  byId("body").replaceChildren(...rows.map((row, i) => tableRow(row, begin + i)));
  byId("table").setAttribute("aria-rowcount", found.length + 1);
  const all = found.length === N ? "" : ` found, of ${count(N)} in all`;
  byId("count").textContent = rows.length
    ? `Photos ${count(begin + 1)} to ${count(begin + rows.length)} of ${count(found.length)}${all}`
    : "No photo matches. Clear the filters to see all.";
  drawPagers();
}
function update() {
  choose();
  state.page = Math.min(state.page, pages() - 1);
  markSort();
  for (const bar of byId("verdicts").querySelectorAll("button")) {
    bar.setAttribute("aria-pressed", String(Number(bar.dataset.kind) === state.kind));
  }
  byId("kind").value = String(state.kind);
  const note = byId("reason-filter");
  note.hidden = !state.only;
  if (state.only) {
    note.replaceChildren(`Only photos ${state.only.label} `, el("button", {type: "button", onclick: () => {
      state.only = null;
      update();
      byId("search").focus();
    }}, "Show all"));
  }
  draw();
}
function showOnly(label, test) {
  resetFilters();
  state.only = {label, test};
  state.page = 0;
  update();
  byId("photos").focus();
  byId("reason-filter").scrollIntoView({block: "center"});
}

// ---- one photo ----
function facts(pairs) {
  return el("dl", {class: "facts"}, ...pairs.filter(([, value]) => value !== "" && value !== null)
    .flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)]));
}
function show(row) {
  const dialog = byId("details");
  const name = visible(C.name[row]);
  const [before, after] = pictureOf(row);
  const picture = (text, title) => (text ? el("figure", {}, webp(text, `${name}, ${title}`, 2), el("figcaption", {}, title)) : null);
  const why = whyNoPicture(row);
  const bracket = DATA.brackets.find((each) => each.name === word("bracket", row) && each.name);
  const left = el("div", {},
    before || after ? el("div", {class: "pair large"}, picture(before, "as encoded"), picture(after, "linearized")) : null,
    why ? el("p", {class: "absent"}, why) : null,
    facts([
      ["Verdict", verdict(C.kind[row])], ["Outcome", word("outcome", row)], ["Estimator", word("estimator", row)],
      ["Reason", visible(word("reason", row))], ["What to do", visible(word("remedy", row))],
      ["Curve of", word("whose", row) === "own" ? "this photo" : word("whose", row) && `its ${word("whose", row)}`],
      ["Faces used", C.faces[row] < 0 ? "" : String(C.faces[row])],
      ["Camera", cameraOf(row)], ["Serial number", visible(word("serial", row))], ["Software", visible(word("software", row))],
      ["Misfit", C.misfit[row] ? `${C.misfit[row]} standard deviations from the camera's curve` : ""],
      ["Bracket", bracket ? `${bracket.photos} photos over ${bracket.stops} stops, from ${visible(bracket.name)}` : ""],
      ["Same bytes as", visible(word("duplicateOf", row))],
      ["File size", `${count(Math.ceil(C.size[row] / 1024))} KiB`],
      ["Time taken", C.seconds[row] ? `${C.seconds[row].toFixed(2)} s` : ""],
    ]));
  const curve = C.curve[row];
  const right = el("div", {},
    curve < 0 ? el("p", {class: "dim"}, "No curve.") : plot(curve, 420, 420),
    curve < 0 ? null : el("p", {class: "hint"}, `Shaded: the 90 % band, ± ${C.band[row].toFixed(1)} % of white on average. Dashed: sRGB.`));
  dialog.replaceChildren(
    el("div", {class: "title"}, el("h2", {id: "details-title"}, name),
      el("button", {type: "button", autofocus: true, onclick: () => dialog.close()}, "Close")),
    el("div", {class: "inside"}, left, right));
  dialog.showModal();
}

// ---- sections above the table ----
function drawHeader() {
  document.title = `facecrf: ${plural(N, "photo")}`;
  byId("about").textContent = `${DATA.source ? `Photos in ${visible(DATA.source)}; outputs` : "Outputs"} in ${visible(DATA.folder)}. Made ${DATA.generated}.`;
  byId("made").textContent = `facecrf-ocio ${DATA.version}. This page holds all it shows and fetches nothing.`;
  const notes = [];
  if (!DATA.sourceThere) notes.push("The folder of the photos was not there when this page was made, so no photo is shown. Mount it and make the report again.");
  if (DATA.pictured < N) notes.push(`${count(DATA.pictured)} of ${count(N)} photos have pictures and curves here, so that the page stays small: first those that do not fit their camera, then weak, reliable and prior-only ones. All are listed.`);
  if (counts[5]) notes.push(`${plural(counts[5], "photo is", "photos are")} unfinished: the batch was interrupted or is still running.`);
  byId("notes").replaceChildren(...notes.map((text) => el("p", {class: "note"}, text)));
}
const hours = (s) => (s >= 3600 ? `${(s / 3600).toFixed(1)} h` : s >= 90 ? `${(s / 60).toFixed(0)} min` : `${s.toFixed(1)} s`);
function drawSummary() {
  const figures = [["photos", count(N)], ["with a curve written", count(withCurve)], ["failed", count(counts[4])]];
  const named = [...cameras.keys()].filter(Boolean).length;
  if (named) figures.push([named === 1 ? "camera model" : "camera models", count(named)]);
  if (misfits) figures.push(["do not fit their camera", count(misfits)]);
  if (DATA.brackets.length) figures.push([DATA.brackets.length === 1 ? "bracket" : "brackets", count(DATA.brackets.length)]);
  if (duplicates) figures.push([duplicates === 1 ? "duplicate" : "duplicates", count(duplicates)]);
  if (seconds) figures.push(["of computing", hours(seconds)]);
  byId("figures").replaceChildren(...figures.map(([name, value]) => el("div", {}, el("dt", {}, name), el("dd", {}, value))));
  const most = Math.max(...counts, 1);
  byId("verdicts").replaceChildren(...DATA.kinds.map((name, kind) => (kind === 5 && !counts[5] ? null : el("li", {},
    el("button", {type: "button", "data-kind": kind, "aria-pressed": "false", onclick: () => {
      state.kind = state.kind === kind ? -1 : kind;
      state.page = 0;
      update();
    }},
    verdict(kind),
    svg("svg", {viewBox: "0 0 100 10", preserveAspectRatio: "none", "aria-hidden": "true"},
      svg("rect", {class: "track", width: 100, height: 10}), svg("rect", {class: `k${kind}`, width: (100 * counts[kind] / most).toFixed(2), height: 10})),
    el("span", {class: "number"}, `${count(counts[kind])} (${percent(counts[kind])})`))))).filter(Boolean));
}
function smallTable(caption, heads, rows) {
  return el("div", {class: "scroll small-table", role: "region", "aria-label": caption, tabindex: "0"},
    el("table", {}, el("caption", {}, caption),
      el("thead", {}, el("tr", {}, ...heads.map(([title, kind]) => el("th", {scope: "col", class: kind || null}, title)))),
      el("tbody", {}, ...rows)));
}
const LISTED = 200;
const showButton = (label, what, test) => el("button", {type: "button", "aria-label": `Show ${what}`, onclick: () => showOnly(label, test)}, "Show");
function capped(rows, what) { return rows.length > LISTED ? `${what}, the first ${LISTED} of ${count(rows.length)}` : what; }
function folded(id, title, rows, body) {
  const section = byId(id);
  section.hidden = false;
  section.append(el("h2", {id: `${id}-title`}, title),
    el("details", {open: rows <= 6}, el("summary", {}, `${plural(rows, "row")}`), body));
}
function drawWhy() {
  const reasons = new Map();
  for (let row = 0; row < N; row++) {
    if (C.kind[row] !== 3 && C.kind[row] !== 4) continue;
    const key = `${C.kind[row]}:${C.reason[row]}`;
    reasons.set(key, (reasons.get(key) || 0) + 1);
  }
  if (!reasons.size) return;
  const sorted = [...reasons].sort((a, b) => b[1] - a[1]);
  const list = sorted.slice(0, 12).map(([key, number]) => {
    const [kind, reason] = key.split(":").map(Number);
    const text = visible(DATA.words[reason]);
    return el("tr", {},
      el("td", {class: "number"}, count(number)), el("td", {}, verdict(kind)), el("th", {scope: "row"}, text),
      el("td", {}, showButton(`with the reason: ${text}`, `photos with the reason ${text}`, (row) => C.kind[row] === kind && C.reason[row] === reason)));
  });
  const rest = sorted.slice(12).reduce((sum, [, number]) => sum + number, 0);
  byId("why").append(el("h3", {}, "Why photos have no curve"),
    smallTable("Reasons, the most frequent first", [["Photos", "number"], ["Verdict"], ["Reason"], ["Filter"]], list));
  if (rest) byId("why").append(el("p", {class: "hint"}, `${plural(rest, "more photo")} with ${plural(sorted.length - 12, "other reason")}: sort the table by reason.`));
}
function drawCameras() {
  if (DATA.groups.length) {
    const groups = [...DATA.groups].sort((a, b) => b.members - a.members);
    const rows = groups.slice(0, LISTED).map((group) => {
      const [make, model, serial, software] = group.camera;
      const name = cameraName(make, model) || "unknown camera";
      const more = [serial && `no. ${serial}`, software, group.style].filter(Boolean).map(visible).join(", ");
      const kind = DATA.kinds.indexOf(group.verdict);
      return el("tr", {},
        el("th", {scope: "row"}, name, more ? el("div", {class: "dim"}, more) : null),
        el("td", {class: "number"}, count(group.members)), el("td", {class: "number"}, count(group.telling)),
        el("td", {class: "number"}, count(group.used)), el("td", {class: "number"}, count(group.misfits)),
        el("td", {}, kind < 0 ? visible(group.verdict) : verdict(kind)),
        el("td", {}, group.curve < 0 ? el("span", {class: "dim"}, "none") : plot(group.curve, 96, 72)),
        el("td", {class: "reason"}, visible(group.reason)),
        el("td", {}, showButton(`of ${name}${more ? ` (${more})` : ""}`, `photos of ${name} ${more}`, (row) => word("group", row) === group.key)));
    });
    folded("cameras", "Cameras", groups.length, smallTable(capped(groups, "One curve for each camera and its settings"),
      [["Camera"], ["Photos", "number"], ["With evidence", "number"], ["Used", "number"], ["Misfits", "number"], ["Verdict"], ["Curve"], ["Reason"], ["Filter"]], rows));
    return;
  }
  const list = [...cameras].sort((a, b) => b[1].reduce((s, n) => s + n, 0) - a[1].reduce((s, n) => s + n, 0));
  if (list.length === 1 && !list[0][0]) return;
  const kinds = DATA.kinds.map((_, kind) => kind).filter((kind) => counts[kind]);
  folded("cameras", "Cameras", list.length, smallTable(capped(list, "Photos of each camera by verdict"),
    [["Camera"], ["Photos", "number"], ...kinds.map((kind) => [kindName(kind), "number"]), ["Filter"]],
    list.slice(0, LISTED).map(([name, each]) => el("tr", {}, el("th", {scope: "row"}, name || "unknown camera"),
      el("td", {class: "number"}, count(each.reduce((s, n) => s + n, 0))),
      ...kinds.map((kind) => el("td", {class: "number"}, count(each[kind]))),
      el("td", {}, showButton(`of ${name || "unknown cameras"}`, `photos of ${name || "unknown cameras"}`, (row) => cameraOf(row) === name))))));
}
function drawBrackets() {
  if (!DATA.brackets.length) return;
  folded("brackets", "Brackets", DATA.brackets.length, smallTable(capped(DATA.brackets, "Exposure series of one scene"),
    [["First photo"], ["Photos", "number"], ["Stops", "number"], ["Curve from exposures"], ["Off the camera's curve [%]", "number"], ["Curve"], ["Reason"], ["Filter"]],
    DATA.brackets.slice(0, LISTED).map((each) => el("tr", {}, el("th", {scope: "row"}, visible(each.name)),
      el("td", {class: "number"}, count(each.photos)), el("td", {class: "number"}, String(each.stops)),
      el("td", {}, each.used ? "used" : "not used"), el("td", {class: "number"}, each.rmse < 0 ? "–" : each.rmse.toFixed(1)),
      el("td", {}, each.curve < 0 ? el("span", {class: "dim"}, "none") : plot(each.curve, 96, 72)),
      el("td", {class: "reason"}, visible(each.reason)),
      el("td", {}, showButton(`of the bracket that begins with ${visible(each.name)}`, `photos of the bracket ${visible(each.name)}`, (row) => word("bracket", row) === each.name))))));
}
function drawSections() {
  byId("sections").replaceChildren(...[...document.querySelectorAll("main > section:not([hidden])")].map((section) =>
    el("li", {}, el("a", {href: `#${section.id}`}, section.querySelector("h2").textContent))));
}

// ---- filters ----
function option(value, text) { return el("option", {value}, text); }
function drawFilters() {
  byId("kind").replaceChildren(option("-1", "all verdicts"), ...DATA.kinds.map((name, kind) => option(String(kind), `${name} (${count(counts[kind])})`)));
  const list = [...cameras.keys()].sort((a, b) => (a < b ? -1 : 1));
  byId("camera").replaceChildren(option("", "all cameras"), ...list.map((name, i) => option(String(i), name || "unknown")));
  const marked = Object.entries(MARKS).filter(([, [, number]]) => number);
  byId("mark").replaceChildren(option("", "anything"), ...marked.map(([key, [name, number]]) => option(key, `${name} (${count(number)})`)));
  byId("camera").closest(".field").hidden = list.length < 2;
  byId("mark").closest(".field").hidden = !marked.length;
  const changed = (act) => (event) => { act(event.target.value); state.page = 0; update(); };
  let waiting = 0;
  byId("search").addEventListener("input", (event) => {
    clearTimeout(waiting);
    waiting = setTimeout(() => {
      state.search = event.target.value.toLowerCase().split(/\s+/).filter(Boolean);
      state.page = 0;
      update();
    }, 150);
  });
  byId("kind").addEventListener("change", changed((value) => { state.kind = Number(value); }));
  byId("camera").addEventListener("change", changed((value) => { state.camera = value === "" ? null : list[Number(value)]; }));
  byId("mark").addEventListener("change", changed((value) => { state.mark = value; }));
  byId("per-page").addEventListener("change", changed((value) => { state.per = Number(value); }));
  byId("filters").addEventListener("submit", (event) => event.preventDefault());
  byId("reset").addEventListener("click", (event) => { event.preventDefault(); resetFilters(); update(); });
}
function resetFilters() {
  Object.assign(state, {search: [], kind: -1, camera: null, mark: "", only: null, page: 0});
  byId("search").value = byId("camera").value = byId("mark").value = "";
}

drawHeader();
drawSummary();
drawWhy();
drawCameras();
drawBrackets();
drawSections();
drawHead();
drawFilters();
update();
})();
