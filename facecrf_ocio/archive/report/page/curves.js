// A curve and its band as a drawing.
let curveTexts = null;
const curveCache = new Map();
function curveOf(index) {
  if (index < 0) return null;
  if (!curveTexts) curveTexts = load("curves");
  if (!curveCache.has(index)) {
    const bytes = Uint8Array.from(atob(curveTexts[index]), (c) => c.charCodeAt(0));
    const view = new DataView(bytes.buffer);
    const values = Array.from(
      {length: bytes.length / 2},
      (_, i) => view.getUint16(2 * i, true) / 65535,
    );
    const samples = DATA.srgb.length;
    const channels = [];
    for (let at = 0; at < values.length; at += 4 * samples) {
      const row = (k) => values.slice(at + k * samples, at + (k + 1) * samples);
      channels.push({
        linear: row(0),
        half: row(1),
        stops: row(2).map((v) => DATA.stopsRange * (2 * v - 1)),
        halfStops: row(3).map((v) => DATA.stopsRange * v),
      });
    }
    curveCache.set(index, channels);
  }
  return curveCache.get(index);
}

function told(channels) {
  const names = channels.length === 1 ? [""] : ["red ", "green ", "blue "];
  const middle = (DATA.srgb.length - 1) / 2;
  const parts = channels.map(
    ({linear, half}, i) =>
      names[i] +
      `${(100 * linear[middle]).toFixed(0)} % give or take ${(100 * half[middle]).toFixed(0)}`,
  );
  return `Curve: the middle code value is ${parts.join(", ")} of white; sRGB would be 21 %`;
}

// Of a drawing: a line through values, a band about them, what axes are called, colors of channels.
const lineThrough = (values, at) => values.map((v, k) => `${k ? "L" : "M"}${at(k, v)}`).join("");
function bandAbout(values, halves, at) {
  const up = lineThrough(
    values.map((v, k) => v + halves[k]),
    at,
  );
  const back = values.map((v, k) => `L${at(k, v - halves[k])}`).reverse();
  return `${up}${back.join("")}Z`;
}
const axisNames = (across, height, upward, below, beside) => [
  svg("text", {x: across, y: height - 5, "text-anchor": "middle"}, below),
  svg(
    "text",
    {x: 11, y: upward, "text-anchor": "middle", transform: `rotate(-90 11 ${upward})`},
    beside,
  ),
];
// An empty plot, and how far its axes are from its left, its bottom and its other edges.
const MARGINS = [44, 40, 8];
const emptyPlot = (width, height, label) =>
  svg("svg", {
    class: "plot",
    width,
    height,
    viewBox: `0 0 ${width} ${height}`,
    role: "img",
    "aria-label": label,
  });
const inColor = (channels, kind, i) => (channels.length === 1 ? "" : ` ${kind}${"rgb"[i]}`);

function plot(index, width, height, label) {
  const channels = curveOf(index);
  const large = width > 200;
  const [left, bottom, edge] = large ? MARGINS : [1, 1, 1];
  const x = (u) => (left + u * (width - left - edge)).toFixed(1);
  const y = (v) => (edge + (1 - Math.min(Math.max(v, 0), 1)) * (height - bottom - edge)).toFixed(1);
  const u = (i) => i / (DATA.srgb.length - 1);
  const at = (i, v) => `${x(u(i))} ${y(v)}`;
  const picture = emptyPlot(width, height, label || told(channels));
  if (large) {
    for (const tick of [0, 0.25, 0.5, 0.75, 1]) {
      picture.append(
        svg("line", {class: "grid", x1: x(tick), x2: x(tick), y1: y(0), y2: y(1)}),
        svg("line", {class: "grid", x1: x(0), x2: x(1), y1: y(tick), y2: y(tick)}),
        svg("text", {x: x(tick), y: height - 24, "text-anchor": "middle"}, String(tick)),
        svg("text", {x: left - 6, y: +y(tick) + 4, "text-anchor": "end"}, String(tick)),
      );
    }
    const names = ["encoded value (1: white)", "linear light (1: white)"];
    picture.append(...axisNames(x(0.5), height, +y(0.5), ...names));
  } else {
    picture.append(
      svg("rect", {class: "frame", x: 0.5, y: 0.5, width: width - 1, height: height - 1}),
    );
  }
  channels.forEach(({linear, half}, i) => {
    if (!half.some((h) => h > 0)) return;
    const area = {class: `area${inColor(channels, "a", i)}`, d: bandAbout(linear, half, at)};
    picture.append(svg("path", area));
  });
  picture.append(svg("path", {class: "reference", d: lineThrough(DATA.srgb, at)}));
  channels.forEach(({linear}, i) => {
    const line = {class: `line${inColor(channels, "c", i)}`, d: lineThrough(linear, at)};
    picture.append(svg("path", line));
  });
  return picture;
}
