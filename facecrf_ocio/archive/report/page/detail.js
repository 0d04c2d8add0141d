// One photo: in a dialog of an archive's report, or on a page of its own.
function facts(pairs) {
  return el(
    "dl",
    {class: "facts"},
    ...pairs
      .filter(([, value]) => value !== "" && value !== null)
      .flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)]),
  );
}
function bracketOf(row) {
  const bracket = DATA.brackets.find((each) => each.name && each.name === word("bracket", row));
  return bracket
    ? `${bracket.photos} photos over ${bracket.stops} stops, from ${visible(bracket.name)}`
    : "";
}
function factsOf(row) {
  const whose = word("whose", row);
  return facts([
    ["Outcome", word("outcome", row)],
    ["Estimator", word("estimator", row)],
    ["Rests on", visible(word("reason", row))],
    ["Curve of", whose === "own" ? "this photo" : whose && `its ${whose}`],
    ["Faces used", C.faces[row] < 0 ? "" : String(C.faces[row])],
    ["Camera", cameraOf(row)],
    ["Serial number", visible(word("serial", row))],
    ["Software", visible(word("software", row))],
    [
      "Misfit",
      C.misfit[row] ? `${C.misfit[row]} standard deviations from the camera's curve` : "",
    ],
    ["Bracket", bracketOf(row)],
    ["Same bytes as", visible(word("duplicateOf", row))],
    ["File size", C.size[row] ? `${count(Math.ceil(C.size[row] / 1024))} KiB` : ""],
    ["Time taken", C.seconds[row] ? `${C.seconds[row].toFixed(2)} s` : ""],
  ]);
}
function curves(row) {
  const curve = C.curve[row];
  if (curve < 0) return [el("p", {class: "dim"}, "No curve.")];
  return [
    plot(curve, 420, 420),
    el(
      "p",
      {class: "hint"},
      `Shaded: the 90 % band, ± ${C.band[row].toFixed(1)} % of white on average. Dashed: sRGB.`,
    ),
    plotStops(curve, 420, 240),
    el("p", {class: "hint"}, "The same in stops above sRGB, equal at code 128."),
  ];
}
function says(row) {
  const text = visible(lineOf(row));
  return el("p", {class: "says"}, verdict(C.kind[row]), ...(text ? typed(`: ${text}.`) : []));
}
function detail(row) {
  const why = whyNoPicture(row);
  return el(
    "div",
    {class: "inside"},
    el(
      "div",
      {},
      compare(row),
      why ? el("p", {class: "absent"}, why) : null,
      says(row),
      nextSteps(row),
      fileLinks(row),
    ),
    el("div", {}, ...curves(row), factsOf(row), unsure(row)),
  );
}
function show(row) {
  const dialog = byId("details");
  dialog.replaceChildren(
    el(
      "div",
      {class: "title"},
      el("h2", {id: "details-title"}, visible(C.name[row])),
      el("button", {type: "button", autofocus: true, onclick: () => dialog.close()}, "Close"),
    ),
    detail(row),
  );
  dialog.showModal();
}
