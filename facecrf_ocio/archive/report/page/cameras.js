// Cameras and their curves.
function drawCameras() {
  if (DATA.groups.length) {
    const groups = [...DATA.groups].sort((a, b) => b.members - a.members);
    const rows = groups.slice(0, LISTED).map((group) => {
      const [make, model, serial, software] = group.camera;
      const name = cameraName(make, model) || "unknown camera";
      const more = [serial && `no. ${serial}`, software, group.style]
        .filter(Boolean)
        .map(visible)
        .join(", ");
      const kind = DATA.kinds.indexOf(group.verdict);
      return el(
        "tr",
        {},
        el("th", {scope: "row"}, name, more ? el("div", {class: "dim"}, more) : null),
        el("td", {class: "number"}, count(group.members)),
        el("td", {class: "number"}, count(group.telling)),
        el("td", {class: "number"}, count(group.used)),
        el("td", {class: "number"}, count(group.misfits)),
        el("td", {}, kind < 0 ? visible(group.verdict) : verdict(kind)),
        el(
          "td",
          {},
          group.curve < 0 ? el("span", {class: "dim"}, "none") : plot(group.curve, 96, 72),
        ),
        el("td", {class: "reason"}, visible(group.reason)),
        el(
          "td",
          {},
          showButton(
            `of ${name}${more ? ` (${more})` : ""}`,
            `photos of ${name} ${more}`,
            (row) => word("group", row) === group.key,
          ),
        ),
      );
    });
    folded(
      "cameras",
      "Cameras",
      groups.length,
      smallTable(
        capped(groups, "One curve for each camera and its settings"),
        [
          ["Camera"],
          ["Photos", "number"],
          ["With evidence", "number"],
          ["Used", "number"],
          ["Misfits", "number"],
          ["Verdict"],
          ["Curve"],
          ["Reason"],
          ["Filter"],
        ],
        rows,
      ),
    );
    return;
  }
  const list = [...cameras].sort(
    (a, b) => b[1].reduce((s, n) => s + n, 0) - a[1].reduce((s, n) => s + n, 0),
  );
  if (list.length === 1 && !list[0][0]) return;
  const kinds = DATA.kinds.map((_, kind) => kind).filter((kind) => counts[kind]);
  folded(
    "cameras",
    "Cameras",
    list.length,
    smallTable(
      capped(list, "Photos of each camera by verdict"),
      [
        ["Camera"],
        ["Photos", "number"],
        ...kinds.map((kind) => [kindName(kind), "number"]),
        ["Filter"],
      ],
      list.slice(0, LISTED).map(([name, each]) =>
        el(
          "tr",
          {},
          el("th", {scope: "row"}, name || "unknown camera"),
          el("td", {class: "number"}, count(each.reduce((s, n) => s + n, 0))),
          ...kinds.map((kind) => el("td", {class: "number"}, count(each[kind]))),
          el(
            "td",
            {},
            showButton(
              `of ${name || "unknown cameras"}`,
              `photos of ${name || "unknown cameras"}`,
              (row) => cameraOf(row) === name,
            ),
          ),
        ),
      ),
    ),
  );
}
