// Photos before and after, parsed block by block.
const blocks = new Map();
function pictureOf(row) {
  const at = C.picture[row];
  if (at < 0) return ["", ""];
  const number = Math.floor(at / DATA.block);
  if (!blocks.has(number)) {
    if (blocks.size > 40) blocks.clear();
    blocks.set(number, load(`pictures-${number}`));
  }
  return blocks.get(number)[at % DATA.block];
}
const webp = (text, alt, scale) => {
  const image = el("img", {alt, decoding: "async"});
  if (scale)
    image.addEventListener("load", () => {
      image.width = scale * image.naturalWidth;
    });
  image.src = `data:image/webp;base64,${text}`;
  return image;
};
function whyNoPicture(row) {
  const missing = word("missing", row);
  if (missing) return missing;
  return C.picture[row] < 0 ? "Left out: too many photos for one page." : "";
}
