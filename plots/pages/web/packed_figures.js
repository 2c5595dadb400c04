// Of pages with large figures: unpacks those that plots/pages/encodings/deflate.hpp has made small.
(() => {
  "use strict";
  async function unpack(image) {
    const packed = Uint8Array.from(atob(image.dataset.packed), character => character.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    const svg = await new Response(stream).arrayBuffer();
    image.src = URL.createObjectURL(new Blob([svg], {type: "image/svg+xml"}));
  }
  if (typeof DecompressionStream === "function")
    for (const image of document.querySelectorAll("img[data-packed]")) unpack(image);
})();
