// The page's head, and its figures.
function drawMade() {
  byId("made").textContent =
    `facecrf-ocio ${DATA.version}. This page holds all it shows and fetches nothing.`;
}
function drawHeader() {
  document.title = `facecrf: ${plural(N, "photo")}`;
  byId("about").textContent =
    (DATA.source ? `Photos in ${visible(DATA.source)}; outputs` : "Outputs") +
    ` in ${visible(DATA.folder)}. Made ${DATA.generated}.`;
  drawMade();
  const notes = [];
  if (!DATA.sourceThere)
    notes.push(
      "The folder of the photos was not there when this page was made, so no photo is shown. " +
        "Mount it and make the report again.",
    );
  if (DATA.pictured < N)
    notes.push(
      `${count(DATA.pictured)} of ${count(N)} photos have pictures and curves here, ` +
        "so that the page stays small: first those that do not fit their camera, " +
        "then weak, reliable and prior-only ones. All are listed.",
    );
  if (DATA.large && DATA.small)
    notes.push(
      `${count(DATA.large)} photos have large pictures in their details, the others small.`,
    );
  if (counts[5])
    notes.push(
      `${plural(counts[5], "photo is", "photos are")} unfinished: ` +
        "the batch was interrupted or is still running.",
    );
  byId("notes").replaceChildren(...notes.map((text) => el("p", {class: "note"}, text)));
}
const hours = (s) =>
  s >= 3600
    ? `${(s / 3600).toFixed(1)} h`
    : s >= 90
      ? `${(s / 60).toFixed(0)} min`
      : `${s.toFixed(1)} s`;
function drawSummary() {
  const figures = [
    ["photos", count(N)],
    ["with a curve written", count(withCurve)],
    ["failed", count(counts[4])],
  ];
  const named = [...cameras.keys()].filter(Boolean).length;
  if (named) figures.push([named === 1 ? "camera model" : "camera models", count(named)]);
  if (misfits) figures.push(["do not fit their camera", count(misfits)]);
  if (DATA.brackets.length)
    figures.push([
      DATA.brackets.length === 1 ? "bracket" : "brackets",
      count(DATA.brackets.length),
    ]);
  if (duplicates)
    figures.push([duplicates === 1 ? "duplicate" : "duplicates", count(duplicates)]);
  if (seconds) figures.push(["of computing", hours(seconds)]);
  byId("figures").replaceChildren(
    ...figures.map(([name, value]) => el("div", {}, el("dt", {}, name), el("dd", {}, value))),
  );
  const most = Math.max(...counts, 1);
  byId("verdicts").replaceChildren(
    ...DATA.kinds
      .map((name, kind) =>
        kind === 5 && !counts[5]
          ? null
          : el(
              "li",
              {},
              el(
                "button",
                {
                  type: "button",
                  "data-kind": kind,
                  "aria-pressed": "false",
                  onclick: () => {
                    state.kind = state.kind === kind ? -1 : kind;
                    state.page = 0;
                    update();
                  },
                },
                verdict(kind),
                svg(
                  "svg",
                  {viewBox: "0 0 100 10", preserveAspectRatio: "none", "aria-hidden": "true"},
                  svg("rect", {class: "track", width: 100, height: 10}),
                  svg("rect", {
                    class: `k${kind}`,
                    width: ((100 * counts[kind]) / most).toFixed(2),
                    height: 10,
                  }),
                ),
                el(
                  "span",
                  {class: "number"},
                  `${count(counts[kind])} (${percent(counts[kind])})`,
                ),
              ),
            ),
      )
      .filter(Boolean),
  );
}
