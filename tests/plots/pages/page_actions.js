// Drives a page with one plain table in a browser: page_browser_test.cpp appends this script. It writes one line for
// each thing that it finds, "name: value", into an element of its own.
"use strict";
setTimeout(() => {
  const lines = [];
  const find = (name, value) => lines.push(name + ": " + value);
  const all = selector => [...document.querySelectorAll(selector)];
  const column = k => all("tbody tr").filter(row => row.closest(".scroll")).map(row => row.cells[k].textContent).join(" ");
  const heading = k => all("thead th")[k].querySelector("button");

  heading(0).click();
  find("name up", column(0));
  heading(1).click();
  find("count up", column(1));
  heading(1).click();
  find("count down", column(1));
  find("direction told", all("thead th").map(cell => cell.getAttribute("aria-sort")).join(" "));
  heading(1).click();
  find("as written", column(1));
  heading(2).click();
  find("time up", column(2));
  heading(3).click();
  find("units", column(3));
  find("buttons", all("table button").length);

  const ground = () => getComputedStyle(document.body).backgroundColor;
  const before = ground();
  document.getElementById("theme").click();
  find("theme changes", ground() !== before);
  find("pictures", all("img").map(image => image.naturalWidth + "x" + image.naturalHeight).join(" "));

  // The table scrolls in its box; nothing else may be wider than the page.
  document.body.style.width = "390px";
  document.body.style.margin = "0";
  const wide = all("body *").filter(one => !one.closest("table") && one.getBoundingClientRect().right > 391);
  find("wider than a phone", wide.length === 0 ? "nothing" : wide.map(one => one.tagName + "." + one.className).join(" "));
  find("errors", page_errors.length === 0 ? "none" : page_errors.join(" | "));
  const made = document.createElement("pre");
  made.id = "findings";
  made.textContent = "\n" + lines.join("\n") + "\n";
  document.body.append(made);
}, 500);
