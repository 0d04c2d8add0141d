// The links to the sections; then everything is drawn once.
function drawSections() {
  byId("sections").replaceChildren(
    ...[...document.querySelectorAll("main > section:not([hidden])")].map((section) =>
      el("li", {}, el("a", {href: `#${section.id}`}, section.querySelector("h2").textContent)),
    ),
  );
}

drawHeader();
drawSummary();
drawWhy();
drawCameras();
drawBrackets();
drawSections();
drawHead();
drawFilters();
update();
