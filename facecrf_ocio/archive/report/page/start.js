// The links to the sections; then everything is drawn once.
function drawSections() {
  byId("sections").replaceChildren(
    ...[...document.querySelectorAll("main > section:not([hidden])")].map((block) =>
      el("li", {}, el("a", {href: `#${block.id}`}, block.querySelector("h2").textContent)),
    ),
  );
}
function drawArchive() {
  drawHeader();
  drawSummary();
  drawWhy();
  drawCameras();
  drawBrackets();
  drawSections();
  drawCaption();
  drawHead();
  drawFilters();
  update();
}
function drawPhoto() {
  const name = visible(C.name[0]);
  document.title = `facecrf: ${name}`;
  byId("title").textContent = name;
  byId("photo").append(detail(0));
  drawMade();
}

if (byId("photo")) drawPhoto();
else drawArchive();
