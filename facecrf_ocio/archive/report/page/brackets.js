// Exposure series.
function drawBrackets() {
  if (!DATA.brackets.length) return;
  folded(
    "brackets",
    "Brackets",
    DATA.brackets.length,
    smallTable(
      capped(DATA.brackets, "Exposure series of one scene"),
      [
        ["First photo"],
        ["Photos", "number"],
        ["Stops", "number"],
        ["Curve from exposures"],
        ["Off the camera's curve [%]", "number"],
        ["Curve"],
        ["Merged"],
        ["Reason"],
        ["Filter"],
      ],
      DATA.brackets.slice(0, LISTED).map((each) =>
        el(
          "tr",
          {},
          el("th", {scope: "row"}, visible(each.name)),
          el("td", {class: "number"}, count(each.photos)),
          el("td", {class: "number"}, String(each.stops)),
          el("td", {}, each.used ? "used" : "not used"),
          el("td", {class: "number"}, each.rmse < 0 ? "–" : each.rmse.toFixed(1)),
          el(
            "td",
            {},
            each.curve < 0 ? el("span", {class: "dim"}, "none") : plot(each.curve, 96, 72),
          ),
          el(
            "td",
            {},
            each.merged ? link(DATA.links[1], each.merged, "EXR") : el("span", {class: "dim"}, "–"),
            each.mergeReason ? el("div", {class: "reason"}, visible(each.mergeReason)) : null,
          ),
          el("td", {class: "reason"}, visible(each.reason)),
          el(
            "td",
            {},
            showButton(
              `of the bracket that begins with ${visible(each.name)}`,
              `photos of the bracket ${visible(each.name)}`,
              (row) => word("bracket", row) === each.name,
            ),
          ),
        ),
      ),
    ),
  );
}
