// Why photos have no curve: reasons by kind, without what is peculiar to one photo.
function drawWhy() {
  const kinds = [4, 3].filter((kind) => counts[kind]);
  if (!kinds.length) return;
  byId("why").append(
    el("h3", {}, "Why photos have no curve"),
    ...kinds.map((kind) => whyTable(kind)),
  );
}
function reasonsOf(kind) {
  const tally = new Map();
  for (let row = 0; row < N; row++) {
    if (C.kind[row] !== kind) continue;
    tally.set(C.reasonKind[row], (tally.get(C.reasonKind[row]) || 0) + 1);
  }
  return [...tally].sort((a, b) => b[1] - a[1]);
}
function whyTable(kind) {
  const all = reasonsOf(kind);
  const rows = all.slice(0, 12).map(([reason, number]) => {
    const text = visible(DATA.words[reason]) || "no reason told";
    return el(
      "tr",
      {},
      el("td", {class: "number"}, count(number)),
      el("th", {scope: "row"}, text),
      el(
        "td",
        {},
        showButton(
          `with the reason: ${text}`,
          `photos with the reason ${text}`,
          (row) => C.kind[row] === kind && C.reasonKind[row] === reason,
        ),
      ),
    );
  });
  const rest = all.slice(12).reduce((sum, [, number]) => sum + number, 0);
  return el(
    "div",
    {},
    smallTable(
      `${kindName(kind)}: ${plural(counts[kind], "photo")}`,
      [["Photos", "number"], ["Reason"], ["Filter"]],
      rows,
    ),
    rest
      ? el(
          "p",
          {class: "hint"},
          `${plural(rest, "more photo")} with other reasons: sort by reason.`,
        )
      : null,
  );
}
