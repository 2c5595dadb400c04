// Of the page of `hmax report`: its data, numbers as text, tables that sort and filter. plots/pages/report_data.hpp
// says what the data is; plots/pages/store_report.cpp puts the scripts together.
"use strict";

const data = JSON.parse(document.getElementById("data").textContent);
const first_rows = 200;
const hidden_cells = 4;  // of each row: store, number, series, case

// ---- Numbers and cells

const minus = text => text.replace("-", "\u2212");

/// Four significant digits; a dash for what is missing.
function number_text(value, digits = 4) {
  if (Number.isNaN(value)) return "\u2013";
  if (!Number.isFinite(value)) return value > 0 ? "unbounded" : "\u2212unbounded";
  const size = Math.abs(value);
  if (size === 0 || (size >= 1e-3 && size < 1e6)) return minus(String(Number(value.toPrecision(digits))));
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  return minus(String(Number(mantissa))) + "e" + minus(String(Number(exponent)));
}

function power_text(exponent) {
  const digits = "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079";
  return "10" + String(exponent).replace("-", "\u207b").replace(/\d/g, digit => digits[digit]);
}

const is_text = column => ["text", "long", "list", "store"].includes(column.form);

/// Paper has no room for long texts.
const class_of = column => column.form === "long" ? "words off-paper" : is_text(column) ? "words" : "";

/// A string, or a number: NaN where there is none.
function value_of(row, column) {
  const cell = row[column.at];
  if (is_text(column)) return (column.form === "store" ? data.stores : data.words)[cell];
  return cell === null ? NaN : cell === "inf" ? Infinity : cell === "-inf" ? -Infinity : cell;
}

function text_of(row, column) {
  const value = value_of(row, column);
  if (is_text(column)) return value === "" ? "\u2013" : value;
  return column.form === "count" && Number.isFinite(value) ? minus(String(value)) : number_text(value);
}

const counted = (count, one, many) => count + " " + (count === 1 ? one : many);
const store_of = row => data.stores[row[0]];
const id_of = (table, row) => table.id + (data.stores.length > 1 ? "-" + (row[0] + 1) : "") + "-" + row[1];

// ---- Elements

function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

function drawn(name, attributes = {}, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

function button(text, action, attributes = {}) {
  const made = element("button", {type: "button", ...attributes}, text);
  made.addEventListener("click", action);
  return made;
}

// ---- Tables

const row_places = new Map();  // id of a row -> what shows it

/// Missing numbers come last in both directions.
function compare_rows(a, b, column, direction) {
  const x = value_of(a, column), y = value_of(b, column);
  if (is_text(column)) return direction * x.localeCompare(y, "en", {numeric: true});
  if (Number.isNaN(x) || Number.isNaN(y)) return Number.isNaN(x) - Number.isNaN(y);
  return x === y ? 0 : direction * (x < y ? -1 : 1);
}

function make_table(table, holder) {
  table.columns.forEach((column, index) => column.at = index + hidden_cells);
  const row_column = {at: 1, name: "row", form: "count"};
  const store_column = {at: 0, name: "store", form: "store"};
  const has_value = column => table.rows.some(row => {
    const value = value_of(row, column);
    return is_text(column) ? value !== "" : !Number.isNaN(value);
  });
  // What every row has in common is told once, above the table.
  const varies = column => column.key === "method" || table.rows.length < 2 ||
      table.rows.some(row => row[column.at] !== table.rows[0][column.at]);
  const with_values = [store_column, ...table.columns.filter(column => column.form !== "list" && has_value(column))];
  const columns = [row_column, ...with_values.filter(varies)], common = with_values.filter(column => !varies(column));
  const state = {sort: row_column, direction: 1, words: [], all: false, printed: false, marked: ""};
  const filter =
      element("input", {type: "search", placeholder: "words of a row", autocomplete: "off", spellcheck: "false"});
  const count = element("output", {class: "count"});
  const more = button("Show all rows", () => {
    state.all = true;
    show();
  });
  const head = element("tr"), body = element("tbody");
  const box = element(
      "div", {class: "box", tabindex: "0", role: "region", "aria-label": table.title},
      element("table", {}, element("thead", {}, head), body));
  holder.append(element("div", {class: "tools"}, element("label", {}, "Filter ", filter), count, more));
  if (common.length > 0) {
    const words = common.flatMap(
        column =>
            [column.name + " ", element("b", {}, text_of(table.rows[0], column)),
             (column.unit ? " " + column.unit : "") + "; "]);
    holder.append(element(
        "p", {class: "common"}, "In every row: ", ...words.slice(0, -1),
        (common.at(-1).unit ? " " + common.at(-1).unit : "")));
  }
  holder.append(box);

  for (const column of columns) {
    const label =
        column.unit ? [column.name, element("span", {class: "unit"}, " [" + column.unit + "]")] : [column.name];
    const cell = element("th", {scope: "col", class: class_of(column)});
    const sorter = button("", () => {
      state.direction = state.sort === column ? -state.direction : 1;
      state.sort = column;
      show();
    });
    sorter.append(...label);
    cell.append(sorter);
    cell.column = column;
    head.append(cell);
  }

  const searched = new Map();
  const search_text = row => {
    if (!searched.has(row))
      searched.set(row, [row_column, ...with_values].map(column => text_of(row, column)).join(" ").toLowerCase());
    return searched.get(row);
  };
  const matching = () => {
    const rows = state.words.length === 0 ?
        table.rows.slice() :
        table.rows.filter(row => state.words.every(word => search_text(row).includes(word)));
    const {sort, direction} = state;
    const by_place = (a, b) => a[0] - b[0] || a[1] - b[1];
    if (sort === row_column) return rows.sort((a, b) => direction * by_place(a, b));
    return rows.sort((a, b) => compare_rows(a, b, sort, direction) || by_place(a, b));
  };

  function row_element(row) {
    const id = id_of(table, row);
    const made = element("tr", {id, class: id === state.marked ? "marked" : ""});
    for (const column of columns) {
      if (column === row_column) {
        made.append(element("th", {scope: "row"}, element("a", {href: "#" + id}, String(row[1]))));
        continue;
      }
      const text = text_of(row, column);
      made.append(element(
          "td", is_text(column) ? {class: class_of(column)} : {},
          column.form === "long" ? element("div", {class: "long", title: text}, text) : text));
    }
    return made;
  }

  function show() {
    const rows = matching();
    const shown = state.all || state.printed ? rows : rows.slice(0, first_rows);
    body.replaceChildren(...shown.map(row_element));
    for (const cell of head.children)
      cell.setAttribute(
          "aria-sort",
          cell.column !== state.sort ? "none" :
              state.direction > 0    ? "ascending" :
                                       "descending");
    const part = shown.length < rows.length ? "first " + shown.length + " of " : "";
    const of_all = rows.length < table.rows.length ? " of " + table.rows.length : "";
    count.textContent = part + (of_all ? rows.length + of_all + " rows" : counted(rows.length, "row", "rows"));
    more.hidden = shown.length === rows.length;
  }

  filter.addEventListener("input", () => {
    state.words = filter.value.toLowerCase().split(/\s+/).filter(word => word);
    show();
  });
  const reveal = row => {
    const rows = matching();
    if (!rows.includes(row)) {
      filter.value = "";
      state.words = [];
    }
    if (!state.all && matching().indexOf(row) >= first_rows) state.all = true;
    state.marked = id_of(table, row);
    show();
    const found = document.getElementById(state.marked);
    found.scrollIntoView({block: "center", inline: "nearest"});
    found.querySelector("a").focus({preventScroll: true});
  };
  for (const row of table.rows) row_places.set(id_of(table, row), () => reveal(row));
  table.print = on => {
    state.printed = on;
    show();
  };
  table.unmark = () => {
    state.marked = "";
    for (const row of body.querySelectorAll(".marked")) row.classList.remove("marked");
  };
  show();
}

function reveal_id(id) {
  const reveal = row_places.get(id);
  if (!reveal) return false;
  for (const table of data.tables) table.unmark();
  reveal();
  return true;
}
