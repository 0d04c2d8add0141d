// Links to a photo and to what was made of it, and what to do next.
// A name that is no text (other bytes than UTF-8) cannot stand in an address: no link then.
function address(base, name) {
  if (!base) return null;
  try {
    return `${base}/${name.split("/").map(encodeURIComponent).join("/")}`;
  } catch {
    return null;
  }
}
function link(base, name, text) {
  const href = address(base, name);
  return href ? el("a", {href}, text) : el("span", {}, text);
}
const lines = (column, row) => word(column, row).split("\n").filter(Boolean);
function fileLinks(row) {
  const [photos, outputs] = DATA.links;
  const name = C.name[row];
  const made = lines("files", row).map((file) => file.replace(/^\*/, () => name));
  const last = (path) => visible(path.slice(path.lastIndexOf("/") + 1));
  const all = made.map((file) => link(outputs, file, last(file)));
  if (photos) all.unshift(link(photos, name, `${last(name)} (the photo)`));
  return all.length
    ? headed("Files", el("ul", {class: "files"}, ...all.map((each) => el("li", {}, each))))
    : null;
}
function headed(title, ...nodes) {
  return el("div", {class: "part"}, el(byId("photo") ? "h2" : "h3", {}, title), ...nodes);
}
function nextSteps(row) {
  const remedy = visible(word("remedy", row));
  const steps = lines("steps", row).map(visible);
  if (!steps.length && remedy) steps.push(`${remedy[0].toUpperCase()}${remedy.slice(1)}.`);
  const items = steps.map((step) => el("li", {}, ...typed(step)));
  return items.length ? headed("Next", el("ul", {class: "steps"}, ...items)) : null;
}
