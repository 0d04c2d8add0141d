// Where a photo's light is unsure: each pixel's band in stops, looked up at its code values.
const UNSURE_SHOWN = 1;
// From none to UNSURE_SHOWN stops, red, green and blue: dark blue over green to yellow (viridis).
const UNSURE_COLORS = [
  [0.27, 0.25, 0.21, 0.13, 0.16, 0.37, 0.68, 0.99],
  [0.0, 0.25, 0.42, 0.57, 0.71, 0.83, 0.91, 0.99],
  [0.33, 0.53, 0.56, 0.55, 0.48, 0.35, 0.13, 0.14],
];

function unsureTables(index) {
  const channels = curveOf(index);
  const each = channels.length === 1 ? [channels[0], channels[0], channels[0]] : channels;
  return each.map(({halfStops}) =>
    halfStops.map((v) => Math.min(v / DATA.ninety / UNSURE_SHOWN, 1).toFixed(3)).join(" "),
  );
}
function unsureFilter(index) {
  const mean = "0.333 0.333 0.333 0 0 ".repeat(3);
  return pixelFilter(
    "unsure",
    byTables(unsureTables(index)),
    svg("feColorMatrix", {type: "matrix", values: `${mean}0 0 0 1 0`}),
    byTables(UNSURE_COLORS.map((row) => row.join(" "))),
  );
}
function unsure(row) {
  const [before, after] = largeOf(row);
  const index = C.curve[row];
  if (index < 0 || !before || before === after) return null;
  if (!curveOf(index).some(({halfStops}) => halfStops.some((v) => v > 0))) return null;
  return el(
    "figure",
    {class: "unsure"},
    webp(before, `${visible(C.name[row])}, where its light is unsure`),
    unsureFilter(index),
    el(
      "figcaption",
      {class: "hint"},
      "Where its light is unsure, by the band at each pixel's code values, mid-gray being 0. " +
        "The channel facecrf.sigma of linearize --uncertainty holds it in units of light.",
    ),
    el(
      "div",
      {class: "scale", "aria-hidden": "true"},
      el("span", {}, "0"),
      el("span", {class: "ramp"}),
      el("span", {}, `${UNSURE_SHOWN} stop (standard deviation) and more`),
    ),
  );
}
