// What is shown, and in which order.
const state = {
  search: [],
  kind: -1,
  camera: null,
  mark: "",
  only: null,
  sort: "name",
  down: false,
  page: 0,
  per: 50,
};
const MARKS = {
  misfit: ["does not fit its camera", misfits, (row) => C.misfit[row]],
  bracket: ["in a bracket", inBrackets, (row) => word("bracket", row)],
  duplicate: ["duplicate", duplicates, (row) => word("duplicateOf", row)],
  pictureless: ["without a picture", pictureless, (row) => word("missing", row)],
};
let haystacks = null;
function haystack(row) {
  if (!haystacks) {
    haystacks = Array.from({length: N}, (_, i) =>
      [
        C.name[i],
        cameraOf(i),
        word("serial", i),
        word("software", i),
        word("outcome", i),
        kindName(C.kind[i]),
        word("estimator", i),
        word("reason", i),
        word("line", i),
        word("remedy", i),
      ]
        .join("\n")
        .toLowerCase(),
    );
  }
  return haystacks[row];
}
const KEYS = {
  name: null, // rows come in this order
  kind: (row) => C.kind[row],
  stops: (row) => (C.stops[row] < 0 ? null : C.stops[row]),
  camera: (row) => cameraOf(row) || null,
  reason: (row) => lineOf(row) || null,
};
let found = [];
function choose() {
  found = [];
  const mark = state.mark ? MARKS[state.mark][2] : null;
  for (let row = 0; row < N; row++) {
    if (state.kind >= 0 && C.kind[row] !== state.kind) continue;
    if (state.camera !== null && cameraOf(row) !== state.camera) continue;
    if (mark && !mark(row)) continue;
    if (state.only && !state.only.test(row)) continue;
    if (state.search.length && !state.search.every((part) => haystack(row).includes(part)))
      continue;
    found.push(row);
  }
  const key = KEYS[state.sort];
  const sign = state.down ? -1 : 1;
  if (!key) {
    if (state.down) found.reverse();
  } else {
    const keys = new Map(found.map((row) => [row, key(row)]));
    found.sort((a, b) => {
      const [p, q] = [keys.get(a), keys.get(b)];
      if (p === q) return a - b;
      if (p === null || q === null) return p === null ? 1 : -1; // what says nothing comes last
      return (typeof p === "string" ? inOrder(p, q) : p - q) * sign;
    });
  }
}
