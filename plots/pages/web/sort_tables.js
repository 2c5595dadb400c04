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

  /// A number for each text where all are numbers of one unit; otherwise null.
  function numbers_of(texts) {
    const numbers = texts.map(text => is_missing(text) ? {value: NaN, unit: null} : number_in(text));
    if (numbers.includes(null)) return null;
    const units = new Set(numbers.map(each => each.unit).filter(unit => unit !== null));
    return units.size > 1 ? null : numbers.map(each => each.value);
  }

  function make_sortable(table) {
    const headings = [...table.tHead.rows[0].cells], body = table.tBodies[0], written = [...body.rows];
    function sort(column, direction) {
      const texts = written.map(row => row.cells[column].textContent.trim()), numbers = numbers_of(texts);
      const compare = (a, b) => {
        const missing = is_missing(texts[a]) - is_missing(texts[b]);  // these come last in both directions
        if (missing !== 0 || is_missing(texts[a])) return missing;
        if (!numbers) return direction * texts[a].localeCompare(texts[b], "en", {numeric: true});
        return numbers[a] === numbers[b] ? 0 : direction * (numbers[a] < numbers[b] ? -1 : 1);
      };
      const order = written.map((_, k) => k);
      if (direction !== 0) order.sort((a, b) => compare(a, b) || a - b);
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
