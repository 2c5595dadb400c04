// Of the page of `hmax report`: fills the page; links to rows, print.
"use strict";

function print(on) {
  for (const table of data.tables) table.print(on);
  for (const figure of data.figures) figure.print(on);
}

for (const table of data.tables) make_table(table, document.getElementById("table-" + table.id));
for (const figure of data.figures) make_figure(figure, document.getElementById("figure-" + figure.id));
window.addEventListener("beforeprint", () => print(true));
window.addEventListener("afterprint", () => print(false));
const follow = () => reveal_id(decodeURIComponent(location.hash.slice(1)));
window.addEventListener("hashchange", follow);
document.addEventListener("click", event => {
  const link = event.target.closest && event.target.closest("a[href^='#']");
  // The browser itself finds no row that is not shown, and tells nothing of a second click on one link.
  if (link && !event.defaultPrevented && link.getAttribute("href") === location.hash && follow())
    event.preventDefault();
});
follow();
