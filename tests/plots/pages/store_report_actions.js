// Drives a page of `hmax report` in a browser: store_report_browser_test.cpp appends this script to a page of 250 runs.
// It writes one line for each thing that it finds, "name: value", into an element of its own.
"use strict";
setTimeout(() => {
  const lines = [];
  const find = (name, value) => lines.push(name + ": " + value);
  const one = selector => document.querySelector(selector);
  const all = selector => [...document.querySelectorAll(selector)];
  const rows = () => all("#table-rows tbody tr");
  const heading = name => all("#table-rows thead th").find(cell => cell.textContent.startsWith(name));
  const column = name => {
    const index = [...heading(name).parentNode.children].indexOf(heading(name));
    return rows().map(row => Number(row.children[index].textContent.replace("\u2212", "-")));
  };
  const is_sorted = (values, direction) =>
      values.every((value, k) => k === 0 || direction * value >= direction * values[k - 1]);

  find("rows at first", rows().length);
  find("count at first", one("#table-rows .count").textContent);
  heading("CPU time").querySelector("button").click();
  find("sorted up", is_sorted(column("CPU time"), 1) + " " + heading("CPU time").getAttribute("aria-sort"));
  heading("CPU time").querySelector("button").click();
  find("sorted down", is_sorted(column("CPU time"), -1) + " " + heading("CPU time").getAttribute("aria-sort"));
  heading("row").querySelector("button").click();
  window.dispatchEvent(new Event("beforeprint"));
  find("rows printed", rows().length + ", drawings " + all("#figure-work_precision .printed svg.figure").length);
  window.dispatchEvent(new Event("afterprint"));
  find("rows after printing", rows().length);
  one("#table-rows .tools button").click();
  find("all rows", rows().length);

  const filter = one("#table-rows input");
  filter.value = "NEWMARK fixed";
  filter.dispatchEvent(new Event("input"));
  find("filtered", rows().length + " " + rows().every(row => row.textContent.includes("newmark")));

  const ground = () => getComputedStyle(document.body).backgroundColor;
  const before = ground();
  one("#theme").click();
  find("theme changes", ground() !== before);
  one("#theme").click();
  find("theme returns", ground() === before);

  const figure = "#figure-work_precision ";
  const mark = all(figure + "svg.figure a")[5], tip = one(figure + ".tip");
  find("tip at first", tip.hidden ? "hidden" : "shown");
  mark.dispatchEvent(new PointerEvent("pointerover", {bubbles: true}));
  find(
      "tip on hover",
      !tip.hidden && /CPU time.*ms/.test(tip.textContent) && /row \d+ of a.sqlite/.test(tip.textContent));
  mark.dispatchEvent(new PointerEvent("pointerout", {bubbles: true}));
  find("tip after hover", tip.hidden ? "hidden" : "shown");
  const first = one(figure + "svg.figure a[tabindex='0']");
  first.focus();
  find("tip on focus", !tip.hidden);
  first.dispatchEvent(new KeyboardEvent("keydown", {key: "ArrowRight", bubbles: true}));
  find("arrow moves", document.activeElement === all(figure + "svg.figure a")[1] && !tip.hidden);
  const target = mark.getAttribute("href");
  mark.dispatchEvent(new MouseEvent("click", {bubbles: true, cancelable: true}));
  find("mark leads to its row", "#" + one("tr.marked").id === target && location.hash === target);

  const marks = all(figure + "svg.figure a").length, toggle = one(figure + ".toggle");
  toggle.click();
  find(
      "hidden by the legend",
      (all(figure + "svg.figure a").length < marks) + " " + toggle.getAttribute("aria-pressed"));
  toggle.click();
  find(
      "shown by the legend",
      (all(figure + "svg.figure a").length === marks) + " " + toggle.getAttribute("aria-pressed"));
  find("unbounded", one("#table-limits").textContent.includes("unbounded"));
  find("markup", document.querySelectorAll(".evil").length);
  find(
      "without names",
      all("button, input, select, svg.figure a")
          .filter(each => !(each.textContent.trim() || each.closest("label") || each.getAttribute("aria-label")))
          .length);

  document.body.style.width = "360px";
  document.body.style.margin = "0";
  setTimeout(() => {
    const wide = all("body *").filter(
        each => !each.closest(".box table, .tip, script, style") && each.getBoundingClientRect().right > 361);
    find("wider than a phone", wide.length === 0 ? "nothing" : wide[0].outerHTML.slice(0, 80).replace(/[<>&]/g, " "));
    find("errors", window.page_errors.length === 0 ? "none" : window.page_errors.join(" "));
    const told = document.createElement("pre");
    told.id = "findings";
    told.textContent = "\n" + lines.join("\n") + "\n";
    document.body.append(told);
  }, 500);
}, 300);
