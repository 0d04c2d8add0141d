// Before and after on top of each other with a slider, shown at any exposure.
const EXPOSURES = [-2, -1, 0, 1, 2, 3];
const toLight = (v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
const toScreen = (v) => (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055);

// What each of 256 screen values becomes: one table, so that nothing is rounded in between.
function exposureTable(stops) {
  const values = Array.from({length: 256}, (_, i) =>
    toScreen(Math.min(toLight(i / 255) * 2 ** stops, 1)).toFixed(4),
  );
  return values.join(" ");
}
function exposureFilter() {
  const table = exposureTable(0);
  return pixelFilter("exposure", byTables([table, table, table]));
}
function exposureButtons(stage, filter) {
  const buttons = EXPOSURES.map((stops) =>
    el(
      "button",
      {
        type: "button",
        "aria-pressed": String(stops === 0),
        "aria-label":
          stops === 0
            ? "As it is"
            : `${plural(Math.abs(stops), "stop")} ${stops > 0 ? "brighter" : "darker"}`,
        onclick: (event) => {
          for (const other of buttons) other.setAttribute("aria-pressed", "false");
          event.currentTarget.setAttribute("aria-pressed", "true");
          stage.classList.toggle("exposed", stops !== 0);
          for (const table of filter.querySelectorAll("[tableValues]"))
            table.setAttribute("tableValues", exposureTable(stops));
        },
      },
      stops > 0 ? `+${stops}` : String(stops).replace("-", "−"),
    ),
  );
  return el(
    "div",
    {class: "exposures", role: "group", "aria-label": "Exposure of both pictures, in stops"},
    el("span", {}, "Exposure, stops"),
    ...buttons,
  );
}
function largeOf(row) {
  const place = C.picture[row];
  const block = place < 0 ? null : byId(`large-${place}`);
  return block ? JSON.parse(block.textContent) : pictureOf(row);
}
function compare(row) {
  const name = visible(C.name[row]);
  const [before, after] = largeOf(row);
  if (!before && !after) return null;
  const image = (text, title) => webp(text, `${name}, ${title}`);
  if (!before || !after || before === after)
    return el("figure", {class: "stage"}, image(before || after, "as it is"));
  const stage = el(
    "div",
    {class: "stage two"},
    image(before, "as encoded"),
    el("div", {class: "over"}, image(after, "linearized")),
    el("span", {class: "tag", "aria-hidden": "true"}, "as encoded"),
    el("span", {class: "tag right", "aria-hidden": "true"}, "linearized"),
    el("span", {class: "seam", "aria-hidden": "true"}),
  );
  const slide = (value) => stage.style.setProperty("--at", `${value}%`);
  slide(50);
  const slider = el("input", {
    type: "range",
    min: 0,
    max: 100,
    value: 50,
    "aria-label": "Where the photo as encoded ends and the linearized one begins",
    "aria-valuetext": "50 % as encoded",
    oninput: (event) => {
      slide(event.currentTarget.value);
      event.currentTarget.setAttribute(
        "aria-valuetext",
        `${event.currentTarget.value} % as encoded`,
      );
    },
  });
  const filter = exposureFilter();
  return el(
    "div",
    {class: "compare"},
    el("div", {class: "slide"}, stage, slider),
    exposureButtons(stage, filter),
    filter,
    el(
      "p",
      {class: "hint"},
      "Drag, or use the arrow keys. Exposure changes both in linear light: the left by sRGB, " +
        "the right by this curve; where they drift apart, sRGB would have been wrong.",
    ),
  );
}
