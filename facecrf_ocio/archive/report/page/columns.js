// The table's columns: those alone whose values differ between photos.
const NONE = "none";
const COLUMNS = [
  {
    title: "Before, after",
    key: null,
    kind: "",
    value: (row) => (C.picture[row] >= 0 || word("missing", row) ? row : NONE),
    said: "no pictures",
  },
  {title: "Photo", key: "name", kind: "", value: (row) => C.name[row]},
  {title: "Verdict", key: "kind", kind: "", value: (row) => kindName(C.kind[row])},
  {title: "Curve", key: null, kind: "", value: (row) => (C.curve[row] < 0 ? NONE : row)},
  {
    title: "Expected error [stops]",
    key: "stops",
    kind: "number",
    value: (row) => (C.stops[row] < 0 ? NONE : C.stops[row].toFixed(2)),
  },
  {title: "Camera", key: "camera", kind: "", value: (row) => cameraOf(row) || "unknown"},
  {title: "What to expect, or why not", key: "reason", kind: "", value: (row) => lineOf(row)},
];
// A column that says one thing of all photos is said once, above the table.
function alike(column) {
  if (N < 2 || column.key === "name") return null;
  const first = column.value(0);
  for (let row = 1; row < N; row++) if (column.value(row) !== first) return null;
  return column.said || `${column.title.toLowerCase().replace(/ \[.*/, "")}: ${first}`;
}
const shown = [];
const saidOnce = [];
for (const column of COLUMNS) {
  const once = alike(column);
  if (once === null) shown.push(column.title);
  else saidOnce.push(once);
}
const isShown = (title) => shown.includes(title);
function drawCaption() {
  byId("alike").textContent = saidOnce.length
    ? ` Alike in all: ${saidOnce.map(visible).join("; ")}.`
    : "";
}
