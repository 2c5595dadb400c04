// Tells the legends of a page of `hmax report`, "figure: curve, curve", and how many curves they hide, as
// store_report_actions.js tells what it finds.
"use strict";
setTimeout(() => {
  const told = document.createElement("pre");
  told.id = "findings";
  const lines = ["work_precision", "device_work_precision", "time_steps"].map(figure => {
    const names = [...document.querySelectorAll("#figure-" + figure + " .legend > span, #figure-" + figure + " .legend button")].map(each => each.textContent.trim());
    return figure + ": " + names.filter(name => name !== "All" && name !== "None").sort().join(", ");
  });
  lines.push("hidden: " + document.querySelectorAll(".legend button[aria-pressed=false]").length);
  lines.push("errors: " + (window.page_errors.length === 0 ? "none" : window.page_errors.join(" ")));
  told.textContent = "\n" + lines.join("\n") + "\n";
  document.body.append(told);
}, 300);
