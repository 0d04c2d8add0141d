// One photo in a dialog.
function facts(pairs) {
  return el(
    "dl",
    {class: "facts"},
    ...pairs
      .filter(([, value]) => value !== "" && value !== null)
      .flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)]),
  );
}
function show(row) {
  const dialog = byId("details");
  const name = visible(C.name[row]);
  const [before, after] = pictureOf(row);
  const picture = (text, title) =>
    text ? el("figure", {}, webp(text, `${name}, ${title}`, 2), el("figcaption", {}, title)) : null;
  const why = whyNoPicture(row);
  const bracket = DATA.brackets.find((each) => each.name === word("bracket", row) && each.name);
  const left = el(
    "div",
    {},
    before || after
      ? el(
          "div",
          {class: "pair large"},
          picture(before, "as encoded"),
          picture(after, "linearized"),
        )
      : null,
    why ? el("p", {class: "absent"}, why) : null,
    facts([
      ["Verdict", verdict(C.kind[row])],
      [
        "Expected error",
        C.stops[row] < 0
          ? ""
          : `${C.stops[row].toFixed(2)} stops over codes 64 to 235, ` +
            `${C.shadows[row].toFixed(2)} in the shadows`,
      ],
      ["Outcome", word("outcome", row)],
      ["Estimator", word("estimator", row)],
      ["Reason", visible(word("reason", row))],
      ["What to do", visible(word("remedy", row))],
      [
        "Curve of",
        word("whose", row) === "own"
          ? "this photo"
          : word("whose", row) && `its ${word("whose", row)}`,
      ],
      ["Faces used", C.faces[row] < 0 ? "" : String(C.faces[row])],
      ["Camera", cameraOf(row)],
      ["Serial number", visible(word("serial", row))],
      ["Software", visible(word("software", row))],
      [
        "Misfit",
        C.misfit[row] ? `${C.misfit[row]} standard deviations from the camera's curve` : "",
      ],
      [
        "Bracket",
        bracket
          ? `${bracket.photos} photos over ${bracket.stops} stops, from ${visible(bracket.name)}`
          : "",
      ],
      ["Same bytes as", visible(word("duplicateOf", row))],
      ["File size", `${count(Math.ceil(C.size[row] / 1024))} KiB`],
      ["Time taken", C.seconds[row] ? `${C.seconds[row].toFixed(2)} s` : ""],
    ]),
  );
  const curve = C.curve[row];
  const right = el(
    "div",
    {},
    curve < 0 ? el("p", {class: "dim"}, "No curve.") : plot(curve, 420, 420),
    curve < 0
      ? null
      : el(
          "p",
          {class: "hint"},
          `Shaded: the 90 % band, ± ${C.band[row].toFixed(1)} % of white on average. ` +
             "Dashed: sRGB.",
        ),
    curve < 0 ? null : plotStops(curve, 420, 240),
    curve < 0
      ? null
      : el("p", {class: "hint"}, "The same in stops above sRGB, equal at code 128."),
  );
  dialog.replaceChildren(
    el(
      "div",
      {class: "title"},
      el("h2", {id: "details-title"}, name),
      el("button", {type: "button", autofocus: true, onclick: () => dialog.close()}, "Close"),
    ),
    el("div", {class: "inside"}, left, right),
  );
  dialog.showModal();
}
