// Of every page: a heading of a table sorts its rows, upwards, downwards, then as they were written. Without this
// script the tables stay as they are.
(() => {
  "use strict";
  const number = /^([<>~\u2248]?)\s*([+\u2212-]?(?:\d{1,3}(?:,\d{3})+|\d+)?(?:\.\d+)?(?:e[+\u2212-]?\d+)?)(?![\d.])(.*)$/i;
  const is_missing = text => text === "" || /^[\u2013\u2014-]+$/.test(text);

  /// {value, unit}, or null for words.
  function number_in(text) {
    if (text === "unbounded") return {value: Infinity, unit: null};
    const found = number.exec(text);
    if (!found || !/\d/.test(found[2])) return null;
    return {value: Number(found[2].replaceAll(",", "").replaceAll("\u2212", "-")), unit: found[3].trim()};
  }

  /// What each cell of a column is sorted by: [class, value]. Numbers come before words where all have one unit; a column of
  /// several units has words only. Dashes come last.
  function keys_of(texts) {
    const numbers = texts.map(text => is_missing(text) ? null : number_in(text));
    const units = new Set(numbers.filter(each => each && each.unit !== null).map(each => each.unit));
    return texts.map((text, k) => is_missing(text) ? [2, ""] :
                             numbers[k] && units.size < 2 ? [0, numbers[k].value] : [1, text]);
  }

  /// The order of classes is the same in both directions.
  function compare(a, b, direction) {
    if (a[0] !== b[0]) return a[0] - b[0];
    if (a[0] === 1) return direction * a[1].localeCompare(b[1], "en", {numeric: true});
    return a[1] === b[1] ? 0 : direction * (a[1] < b[1] ? -1 : 1);
  }

  function make_sortable(table) {
    const headings = [...table.tHead.rows[0].cells], body = table.tBodies[0], written = [...body.rows];
    function sort(column, direction) {
      const keys = keys_of(written.map(row => row.cells[column].textContent.trim()));
      const order = written.map((_, k) => k);
      if (direction !== 0) order.sort((a, b) => compare(keys[a], keys[b], direction) || a - b);
      body.append(...order.map(k => written[k]));
    }
    headings.forEach((heading, column) => {
      const button = document.createElement("button");
      button.type = "button";
      button.append(...heading.childNodes);
      heading.append(button);
      heading.setAttribute("aria-sort", "none");
      button.addEventListener("click", () => {
        const next = {none: "ascending", ascending: "descending", descending: "none"}[heading.getAttribute("aria-sort")];
        for (const each of headings) each.setAttribute("aria-sort", "none");
        heading.setAttribute("aria-sort", next);
        sort(column, {none: 0, ascending: 1, descending: -1}[next]);
      });
    });
  }

  for (const table of document.querySelectorAll("table")) {
    const rows = table.tHead?.rows.length === 1 && table.tBodies.length === 1 ? [...table.tBodies[0].rows] : [];
    const regular = rows.every(row => row.cells.length === table.tHead.rows[0].cells.length);
    if (rows.length > 1 && regular) make_sortable(table);
  }
})();
