// Of the page of `hmax report`: fills the page; the theme, links to rows, print.
"use strict";

function make_theme_button(made) {
  const root = document.documentElement, dark = window.matchMedia("(prefers-color-scheme: dark)");
  let chosen = null;
  try {
    chosen = localStorage.getItem("hmax-theme");
  } catch { /* a file may have no storage */
  }
  const now = () => root.dataset.theme ?? (dark.matches ? "dark" : "light");
  const name = () => made.textContent = now() === "dark" ? "Light theme" : "Dark theme";
  if (chosen === "dark" || chosen === "light") root.dataset.theme = chosen;
  made.addEventListener("click", () => {
    root.dataset.theme = now() === "dark" ? "light" : "dark";
    try {
      localStorage.setItem("hmax-theme", root.dataset.theme);
    } catch { /* the choice lasts as long as the page */
    }
    name();
  });
  dark.addEventListener("change", name);
  made.hidden = false;
  name();
}

function print(on) {
  for (const table of data.tables) table.print(on);
  for (const figure of data.figures) figure.print(on);
}

make_theme_button(document.getElementById("theme"));
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
