// Of every page: a button that changes between the light and the dark theme. The choice is kept for other pages.
(() => {
  "use strict";
  const made = document.getElementById("theme");
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
})();
