// What the rows say, and how many say it.
// "NIKON CORPORATION" of "NIKON D70" need not be said twice.
const firstWord = (text) => text.toLowerCase().split(" ")[0];
const cameraName = (make, model) =>
  visible(firstWord(model) === firstWord(make) ? model : `${make} ${model}`.trim());
const cameraOf = (row) => cameraName(word("make", row), word("model", row));
const kindName = (kind) => DATA.kinds[kind];
const verdict = (kind) => el("span", {class: `verdict k${kind}`}, kindName(kind));
// What to expect of a photo's curve, or why it has none.
const lineOf = (row) => word("line", row) || word("reason", row);
const counts = DATA.kinds.map(() => 0);
let duplicates = 0,
  misfits = 0,
  inBrackets = 0,
  pictureless = 0,
  seconds = 0,
  withCurve = 0;
const cameras = new Map();
for (let row = 0; row < N; row++) {
  counts[C.kind[row]]++;
  seconds += C.seconds[row];
  if (word("whose", row)) withCurve++;
  if (word("duplicateOf", row)) duplicates++;
  if (C.misfit[row]) misfits++;
  if (word("bracket", row)) inBrackets++;
  if (word("missing", row)) pictureless++;
  const name = cameraOf(row);
  if (!cameras.has(name))
    cameras.set(
      name,
      DATA.kinds.map(() => 0),
    );
  cameras.get(name)[C.kind[row]]++;
}
