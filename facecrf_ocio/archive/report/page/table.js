// The table of photos.
function drawHead() {
  byId("head").replaceChildren(
    ...COLUMNS.filter(({title}) => isShown(title)).map(({title, key, kind}) => {
      if (!key) return el("th", {scope: "col", class: kind}, title);
      const arrow = el("span", {class: "arrow", "aria-hidden": "true"}, "↕");
      const heading = el("th", {scope: "col", class: kind, "data-key": key});
      heading.append(
        el(
          "button",
          {
            type: "button",
            onclick: () => {
              state.down = state.sort === key ? !state.down : false;
              state.sort = key;
              state.page = 0;
              update();
            },
          },
          title,
          arrow,
        ),
      );
      return heading;
    }),
  );
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
  return el(
    "td",
    {},
    el(
      "div",
      {class: "pair"},
      before ? webp(before, `${name}, as encoded`) : null,
      after ? webp(after, `${name}, linearized`) : null,
    ),
    why ? el("p", {class: "absent"}, why) : null,
  );
}
function marks(row) {
  const all = [];
  if (C.misfit[row])
    all.push(el("li", {class: "misfit"}, `does not fit its camera: ${C.misfit[row]} s.d.`));
  if (word("whose", row) === "camera") all.push(el("li", {}, "curve of its camera"));
  if (word("whose", row) === "bracket") all.push(el("li", {}, "curve of its bracket"));
  else if (word("bracket", row)) all.push(el("li", {}, "in a bracket"));
  if (word("duplicateOf", row))
    all.push(el("li", {}, `same as ${visible(word("duplicateOf", row))}`));
  return all.length ? el("ul", {class: "marks", "aria-label": "Marks"}, ...all) : null;
}
function reasonNodes(row) {
  const [line, remedy] = [visible(word("line", row)), visible(word("remedy", row))];
  if (line) return typed(line);
  return [
    visible(word("reason", row)),
    remedy ? el("span", {class: "remedy"}, ...typed(`; ${remedy}`)) : null,
  ];
}
function tableRow(row, position) {
  const curve = C.curve[row];
  const stops = C.stops[row];
  const name = el(
    "th",
    {scope: "row"},
    el(
      "button",
      {type: "button", class: "link", "aria-haspopup": "dialog", onclick: () => show(row)},
      visible(C.name[row]),
    ),
    marks(row),
  );
  const all = [
    pairCell(row),
    name,
    el("td", {}, verdict(C.kind[row])),
    el("td", {}, curve < 0 ? el("span", {class: "dim"}, "none") : plot(curve, 96, 72)),
    el("td", {class: "number"}, stops < 0 ? "–" : stops.toFixed(2)),
    el("td", {class: "camera"}, cameraOf(row) || el("span", {class: "dim"}, "unknown")),
    el("td", {class: "reason"}, ...reasonNodes(row)),
  ];
  const titles = COLUMNS.map(({title}) => title);
  const kept = all.map((_, i) => i).filter((i) => isShown(titles[i]));
  return titled(
    el("tr", {"aria-rowindex": position + 2}, ...kept.map((i) => all[i])),
    kept.map((i) => titles[i]),
  );
}
