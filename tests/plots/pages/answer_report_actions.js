// Looks at a page about one answer in a browser: answer_report_test.cpp appends this script.
"use strict";
setTimeout(() => {
  const all = selector => [...document.querySelectorAll(selector)];
  all("#figure-frame_times a")[0].dispatchEvent(new MouseEvent("click", {bubbles: true, cancelable: true}));
  const lines = [
    "figures: " + all(".figures svg.figure").filter(svg => !svg.closest(".printed")).length,
    "rows: " + all("#table-advice tbody tr").length,
    "body: " + all("figure.scene canvas, figure.scene .scene-picture").filter(one => one.offsetParent !== null).length,
    "mark leads to its row: " + (all("tr.marked")[0]?.id ?? "nowhere"),
    "errors: " + (page_errors.length === 0 ? "none" : page_errors.join(" | "))
  ];
  const made = document.createElement("pre");
  made.id = "findings";
  made.textContent = "\n" + lines.join("\n") + "\n";
  document.body.append(made);
}, 500);
