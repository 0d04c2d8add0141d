// The table's pages.
function pages() {
  return Math.max(Math.ceil(found.length / state.per), 1);
}
function drawPagers() {
  for (const pager of document.querySelectorAll(".pager")) {
    if (!pager.childElementCount) {
      const lower = pager.getAttribute("aria-label").includes("below");
      const step = (name, sign, to) =>
        el(
          "button",
          {
            type: "button",
            "data-step": name,
            "aria-label": `${name} page`,
            onclick: (event) => {
              if (event.currentTarget.getAttribute("aria-disabled") === "true") return;
              state.page = to();
              draw();
              if (lower) document.querySelector(".scroll").focus();
            },
          },
          sign,
        );
      pager.append(
        step("First", "«", () => 0),
        step("Previous", "‹", () => state.page - 1),
        el("span", {}),
        step("Next", "›", () => state.page + 1),
        step("Last", "»", () => pages() - 1),
      );
    }
    pager.querySelector("span").textContent = `Page ${count(state.page + 1)} of ${count(pages())}`;
    for (const button of pager.querySelectorAll("button")) {
      const ended = ["First", "Previous"].includes(button.dataset.step)
        ? state.page === 0
        : state.page >= pages() - 1;
      button.setAttribute("aria-disabled", String(ended));
    }
  }
}
function draw() {
  const begin = state.page * state.per;
  const rows = found.slice(begin, begin + state.per);
  byId("body").replaceChildren(...rows.map((row, i) => tableRow(row, begin + i)));
  byId("table").setAttribute("aria-rowcount", found.length + 1);
  const all = found.length === N ? "" : ` found, of ${count(N)} in all`;
  byId("count").textContent = rows.length
    ? `Photos ${count(begin + 1)} to ${count(begin + rows.length)} of ${count(found.length)}${all}`
    : "No photo matches. Clear the filters to see all.";
  drawPagers();
}
function update() {
  choose();
  state.page = Math.min(state.page, pages() - 1);
  markSort();
  for (const bar of byId("verdicts").querySelectorAll("button")) {
    bar.setAttribute("aria-pressed", String(Number(bar.dataset.kind) === state.kind));
  }
  byId("kind").value = String(state.kind);
  byId("sort").value = state.sort;
  const note = byId("reason-filter");
  note.hidden = !state.only;
  if (state.only) {
    note.replaceChildren(
      `Only photos ${state.only.label} `,
      el(
        "button",
        {
          type: "button",
          onclick: () => {
            state.only = null;
            update();
            byId("search").focus();
          },
        },
        "Show all",
      ),
    );
  }
  draw();
}
function showOnly(label, test) {
  resetFilters();
  state.only = {label, test};
  state.page = 0;
  update();
  byId("photos").focus();
  byId("reason-filter").scrollIntoView({block: "center"});
}
