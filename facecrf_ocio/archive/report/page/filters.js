// The filters above the table.
function option(value, text) {
  return el("option", {value}, text);
}
function drawFilters() {
  byId("kind").replaceChildren(
    option("-1", "all verdicts"),
    ...DATA.kinds.map((name, kind) => option(String(kind), `${name} (${count(counts[kind])})`)),
  );
  const list = [...cameras.keys()].sort(inOrder);
  byId("camera").replaceChildren(
    option("", "all cameras"),
    ...list.map((name, i) => option(String(i), name || "unknown")),
  );
  const marked = Object.entries(MARKS).filter(([, [, number]]) => number);
  byId("mark").replaceChildren(
    option("", "anything"),
    ...marked.map(([key, [name, number]]) => option(key, `${name} (${count(number)})`)),
  );
  byId("camera").closest(".field").hidden = list.length < 2;
  byId("mark").closest(".field").hidden = !marked.length;
  const changed = (act) => (event) => {
    act(event.target.value);
    state.page = 0;
    update();
  };
  let waiting = 0;
  byId("search").addEventListener("input", (event) => {
    clearTimeout(waiting);
    waiting = setTimeout(() => {
      state.search = event.target.value.toLowerCase().split(/\s+/).filter(Boolean);
      state.page = 0;
      update();
    }, 150);
  });
  byId("kind").addEventListener(
    "change",
    changed((value) => {
      state.kind = Number(value);
    }),
  );
  byId("camera").addEventListener(
    "change",
    changed((value) => {
      state.camera = value === "" ? null : list[Number(value)];
    }),
  );
  byId("mark").addEventListener(
    "change",
    changed((value) => {
      state.mark = value;
    }),
  );
  byId("per-page").addEventListener(
    "change",
    changed((value) => {
      state.per = Number(value);
    }),
  );
  byId("sort").replaceChildren(
    ...COLUMNS.filter(({title, key}) => key && isShown(title)).map(({title, key}) =>
      option(key, title),
    ),
  );
  byId("sort").addEventListener(
    "change",
    changed((value) => Object.assign(state, {sort: value, down: false})),
  );
  byId("filters").addEventListener("submit", (event) => event.preventDefault());
  byId("reset").addEventListener("click", (event) => {
    event.preventDefault();
    resetFilters();
    update();
  });
}
function resetFilters() {
  Object.assign(state, {search: [], kind: -1, camera: null, mark: "", only: null, page: 0});
  byId("search").value = byId("camera").value = byId("mark").value = "";
}
