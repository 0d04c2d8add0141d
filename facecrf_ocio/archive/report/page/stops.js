// How many stops a curve lies above sRGB, with the free factor out at mid-gray, and its band.
const STOPS_SHOWN = 2;
function plotStops(index, width, height) {
  const channels = curveOf(index);
  const [left, bottom, edge] = [44, 40, 8];
  const first = Math.round((16 / 255) * (DATA.srgb.length - 1));
  const u = (k) => k / (DATA.srgb.length - 1);
  const x = (v) => (left + v * (width - left - edge)).toFixed(1);
  const y = (v) => (edge + (0.5 - v / (2 * STOPS_SHOWN)) * (height - bottom - edge)).toFixed(1);
  const path = (values) =>
    values
      .slice(first)
      .map((v, k) => `${k ? "L" : "M"}${x(u(first + k))} ${y(v)}`)
      .join("");
  const picture = svg("svg", {
    class: "plot",
    width,
    height,
    viewBox: `0 0 ${width} ${height}`,
    role: "img",
    "aria-label": "Stops above sRGB at each code value, equal at code 128",
  });
  for (const tick of [-2, -1, 0, 1, 2]) {
    picture.append(
      svg("line", {
        class: tick ? "grid" : "reference",
        x1: x(0),
        x2: x(1),
        y1: y(tick),
        y2: y(tick),
      }),
      svg("text", {x: left - 6, y: +y(tick) + 4, "text-anchor": "end"}, String(tick)),
    );
  }
  for (const code of [16, 64, 128, 192, 255]) {
    const at = x(code / 255);
    picture.append(
      svg("line", {class: "grid", x1: at, x2: at, y1: y(-2), y2: y(2)}),
      svg(
        "text",
        {x: at, y: height - 24, "text-anchor": code === 255 ? "end" : "middle"},
        String(code),
      ),
    );
  }
  const half = +y(0);
  picture.append(
    svg("text", {x: x(0.5), y: height - 5, "text-anchor": "middle"}, "8-bit code"),
    svg(
      "text",
      {x: 11, y: half, "text-anchor": "middle", transform: `rotate(-90 11 ${half})`},
      "stops above sRGB",
    ),
  );
  const color = (kind, i) => (channels.length === 1 ? "" : ` ${kind}${"rgb"[i]}`);
  // A drawing of its own shows nothing beyond its edges: curves leave it where they are far off.
  const [across, down] = [width - left - edge, height - bottom - edge];
  const inside = svg("svg", {
    x: left,
    y: edge,
    width: across,
    height: down,
    viewBox: `${left} ${edge} ${across} ${down}`,
  });
  channels.forEach(({stops, halfStops}, i) => {
    const up = path(stops.map((v, k) => v + halfStops[k]));
    const back = stops
      .map((v, k) => `L${x(u(k))} ${y(v - halfStops[k])}`)
      .slice(first)
      .reverse()
      .join("");
    inside.append(svg("path", {class: `area${color("a", i)}`, d: `${up}${back}Z`}));
  });
  channels.forEach(({stops}, i) =>
    inside.append(svg("path", {class: `line${color("c", i)}`, d: path(stops)})),
  );
  picture.append(inside);
  return picture;
}
