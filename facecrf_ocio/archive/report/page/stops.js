// How many stops a curve lies above sRGB, with the free factor out at mid-gray, and its band.
const STOPS_SHOWN = 2;
function plotStops(index, width, height) {
  const channels = curveOf(index);
  const [left, bottom, edge] = MARGINS;
  const first = Math.round((16 / 255) * (DATA.srgb.length - 1));
  const u = (k) => k / (DATA.srgb.length - 1);
  const x = (v) => (left + v * (width - left - edge)).toFixed(1);
  const y = (v) => (edge + (0.5 - v / (2 * STOPS_SHOWN)) * (height - bottom - edge)).toFixed(1);
  const at = (k, v) => `${x(u(first + k))} ${y(v)}`;
  const label = "Stops above sRGB at each code value, equal at code 128";
  const picture = emptyPlot(width, height, label);
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
    const across = x(code / 255);
    picture.append(
      svg("line", {class: "grid", x1: across, x2: across, y1: y(-2), y2: y(2)}),
      svg(
        "text",
        {x: across, y: height - 24, "text-anchor": code === 255 ? "end" : "middle"},
        String(code),
      ),
    );
  }
  picture.append(...axisNames(x(0.5), height, +y(0), "8-bit code", "stops above sRGB"));
  // A drawing of its own shows nothing beyond its edges: curves leave it where they are far off.
  const [wide, high] = [width - left - edge, height - bottom - edge];
  const inside = svg("svg", {
    x: left,
    y: edge,
    width: wide,
    height: high,
    viewBox: `${left} ${edge} ${wide} ${high}`,
  });
  channels.forEach(({stops, halfStops}, i) => {
    const band = bandAbout(stops.slice(first), halfStops.slice(first), at);
    inside.append(svg("path", {class: `area${inColor(channels, "a", i)}`, d: band}));
  });
  channels.forEach(({stops}, i) => {
    const line = lineThrough(stops.slice(first), at);
    inside.append(svg("path", {class: `line${inColor(channels, "c", i)}`, d: line}));
  });
  picture.append(inside);
  return picture;
}
