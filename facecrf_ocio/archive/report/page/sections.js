// Small tables above the table of photos.
function smallTable(caption, heads, rows) {
  for (const row of rows)
    titled(
      row,
      heads.map(([title]) => title),
    );
  return el(
    "div",
    {class: "scroll small-table", role: "region", "aria-label": caption, tabindex: "0"},
    el(
      "table",
      {},
      el("caption", {}, caption),
      el(
        "thead",
        {},
        el(
          "tr",
          {},
          ...heads.map(([title, kind]) => el("th", {scope: "col", class: kind || null}, title)),
        ),
      ),
      el("tbody", {}, ...rows),
    ),
  );
}
const LISTED = 200;
const showButton = (label, what, test) =>
  el(
    "button",
    {type: "button", "aria-label": `Show ${what}`, onclick: () => showOnly(label, test)},
    "Show",
  );
function capped(rows, what) {
  return rows.length > LISTED ? `${what}, the first ${LISTED} of ${count(rows.length)}` : what;
}
function folded(id, title, rows, body) {
  const section = byId(id);
  section.hidden = false;
  section.append(
    el("h2", {id: `${id}-title`}, title),
    el("details", {open: rows <= 6}, el("summary", {}, `${plural(rows, "row")}`), body),
  );
}
