// Small tables above the table of photos.
function smallTable(caption, heads, rows) {
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
    return el(
      "tr",
      {},
      el("td", {class: "number"}, count(number)),
      el("td", {}, verdict(kind)),
      el("th", {scope: "row"}, text),
      el(
        "td",
        {},
        showButton(
          `with the reason: ${text}`,
          `photos with the reason ${text}`,
          (row) => C.kind[row] === kind && C.reason[row] === reason,
        ),
      ),
    );
  });
  const rest = sorted.slice(12).reduce((sum, [, number]) => sum + number, 0);
  byId("why").append(
    el("h3", {}, "Why photos have no curve"),
    smallTable(
      "Reasons, the most frequent first",
      [["Photos", "number"], ["Verdict"], ["Reason"], ["Filter"]],
      list,
    ),
  );
  if (rest)
    byId("why").append(
      el(
        "p",
        {class: "hint"},
        `${plural(rest, "more photo")} with ${plural(sorted.length - 12, "other reason")}: ` +
          "sort the table by reason.",
      ),
    );
}
