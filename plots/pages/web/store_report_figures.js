// Of the page of `hmax report`: figures whose marks show their values and lead to the rows of the tables.
"use strict";

// ---- Axes

/// A logarithmic axis from pixel `from` to pixel `to` over what of `values` is positive and finite.
function logarithmic(values, from, to) {
  const low = Math.min(...values), high = Math.max(...values);
  const margin = Math.max(0.06 * Math.log10(high / low), 0.15);
  const a = Math.log10(low) - margin, b = Math.log10(high) + margin;
  const at = value => from + (to - from) * (Math.log10(value) - a) / (b - a);
  const few = Math.max(2, Math.floor(Math.abs(to - from) / 55));
  const ticks = [];
  const stride = Math.max(1, Math.ceil((b - a) / few));
  for (let k = Math.ceil(a / stride) * stride; k <= b; k += stride) ticks.push(k);
  const marks = ticks.map(
      k =>
          ({value: 10 ** k, text: Math.abs(k) <= 3 ? minus(String(Number((10 ** k).toPrecision(3)))) : power_text(k)}));
  if (b - a < 2.5)
    for (let k = Math.floor(a); k <= b; ++k)
      for (const factor of b - a < 0.9 ? [2, 3, 4, 5, 6, 8] : [2, 5]) {
        const value = factor * 10 ** k, where = Math.log10(value);
        if (where >= a && where <= b) marks.push({value, text: number_text(value, 2)});
      }
  return {at, marks, low: 10 ** a, high: 10 ** b};
}

const usable = value => Number.isFinite(value) && value > 0;

function draw_axes(svg, x, y, frame, labels) {
  const grid = drawn("g", {class: "grid"}), names = drawn("g", {class: "tick"});
  for (const {value, text} of x.marks) {
    grid.append(drawn("line", {x1: x.at(value), x2: x.at(value), y1: frame.top, y2: frame.bottom}));
    names.append(drawn("text", {x: x.at(value), y: frame.bottom + 16, "text-anchor": "middle"}, text));
  }
  for (const {value, text} of y ? y.marks : []) {
    grid.append(drawn("line", {x1: frame.left, x2: frame.right, y1: y.at(value), y2: y.at(value)}));
    names.append(drawn("text", {x: frame.left - 6, y: y.at(value) + 4, "text-anchor": "end"}, text));
  }
  const middle = (frame.top + frame.bottom) / 2;
  names.append(
      drawn("text", {x: (frame.left + frame.right) / 2, y: frame.bottom + 35, "text-anchor": "middle"}, labels.x));
  if (labels.y)
    names.append(
        drawn("text", {x: 13, y: middle, "text-anchor": "middle", transform: `rotate(-90 13 ${middle})`}, labels.y));
  svg.append(grid, names, drawn("rect", {
               class: "frame",
               x: frame.left,
               y: frame.top,
               width: frame.right - frame.left,
               height: frame.bottom - frame.top
             }));
}

// ---- Marks

const shapes = [
  r => `M${- r} 0a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${- 2 * r} 0z`,
  r => `M${- r} ${- r}h${2 * r}v${2 * r}h${- 2 * r}z`,
  r => `M0 ${- 1.2 * r}L${1.15 * r} ${0.9 * r}H${- 1.15 * r}z`,
  r => `M0 ${- 1.35 * r}L${1.35 * r} 0L0 ${1.35 * r}L${- 1.35 * r} 0z`,
  r => `M0 ${1.2 * r}L${1.15 * r} ${- 0.9 * r}H${- 1.15 * r}z`,
  r => `M${- 0.4 * r} ${- 1.2 * r}h${0.8 * r}v${0.8 * r}h${0.8 * r}v${0.8 * r}h${- 0.8 * r}v${0.8 * r}h${- 0.8 * r}v${
      - 0.8 * r}h${- 0.8 * r}v${- 0.8 * r}h${0.8 * r}z`,
  r => `M${- 1.2 * r} 0L${- 0.6 * r} ${- r}H${0.6 * r}L${1.2 * r} 0L${0.6 * r} ${r}H${- 0.6 * r}z`,
  r => `M${- 1.1 * r} ${- 1.1 * r}L${1.1 * r} ${- 1.1 * r}L${- 1.1 * r} ${1.1 * r}H${1.1 * r}z`,
];

/// Methods have colours in their order; where colours repeat, shapes differ.
function style_of(series) {
  const {method, variant} = data.series[series];
  const colour = `var(--c${method % 8})`;
  const shape = shapes[(method + Math.floor(method / 8) + 3 * Math.floor(variant / 2)) % shapes.length];
  return {colour, shape, hollow: variant % 2 === 1, dash: ["", "6 4", "2 3", "9 3 2 3"][variant % 4]};
}

function mark_path(series, radius) {
  const {colour, shape, hollow} = style_of(series);
  return drawn("path", {
    class: "mark",
    d: shape(radius),
    style: hollow ? `fill:var(--page);stroke:${colour};stroke-width:2` : `fill:${colour}`
  });
}

/// What is said of a row beside its mark.
function tip_lines(table, row) {
  const lines = [[data.series[row[2]].label, ""]];
  for (const column of table.columns)
    if (table.tips.includes(column.key) && text_of(row, column) !== "\u2013")
      lines.push([column.name, text_of(row, column) + (column.unit ? " " + column.unit : "")]);
  lines.push(["row " + row[1] + " of " + store_of(row), ""]);
  return lines;
}

function link_to_row(table, row, plot, at, ...children) {
  const lines = tip_lines(table, row);
  const words = lines.map(([name, value]) => value ? name + " " + value : name).join("; ");
  const made = drawn(
      "a", {href: "#" + id_of(table, row), tabindex: "-1", "aria-label": words, "data-series": row[2]}, ...children);
  plot.targets.set(made, {lines, at, id: id_of(table, row)});
  return made;
}

/// Values beside the mark that has the pointer or the focus; a click leads to its row.
function follow_marks(plot) {
  const mark_of = event => plot.targets.has(event.target.closest("a")) ? event.target.closest("a") : null;
  const hide = () => plot.tip.hidden = true;
  const show = event => {
    const mark = mark_of(event);
    if (!mark) return;
    const {lines, at} = plot.targets.get(mark);
    plot.tip.replaceChildren(
        ...lines.map(([name, value]) => element("div", {}, name, value ? element("b", {}, value) : "")));
    plot.tip.hidden = false;
    const width = plot.box.clientWidth, size = plot.tip.offsetWidth;
    plot.tip.style.left = Math.max(0, Math.min(width - size, at.x - size / 2)) + "px";
    const above = at.y - plot.tip.offsetHeight - 14;
    plot.tip.style.top = (above >= 0 ? above : at.y + 16) + "px";
  };
  for (const name of ["pointerover", "focusin"]) plot.box.addEventListener(name, show);
  for (const name of ["pointerout", "focusout"]) plot.box.addEventListener(name, hide);
  plot.box.addEventListener("click", event => {
    const mark = mark_of(event);
    if (!mark) return;
    event.preventDefault();
    hide();
    history.pushState(null, "", mark.getAttribute("href"));
    reveal_id(plot.targets.get(mark).id);
  });
}

/// One mark of a figure is reached by Tab, the others from it by arrows: right and left along a series, up and down
/// between series.
function walk_by_arrows(svg) {
  const links = [...svg.querySelectorAll("a")];
  if (links.length) links[0].setAttribute("tabindex", "0");
  const series = link => link.getAttribute("data-series");
  svg.addEventListener("keydown", event => {
    const now = links.indexOf(document.activeElement);
    if (now < 0) return;
    const other = step => {
      for (let k = now + step; links[k]; k += step)
        if (series(links[k]) !== series(links[now])) return k;
      return now;
    };
    const next = {
      ArrowRight: () => now + 1,
      ArrowLeft: () => now - 1,
      ArrowDown: () => other(1),
      ArrowUp: () => other(-1),
      Home: () => 0,
      End: () => links.length - 1
    }[event.key];
    if (!next) return;
    event.preventDefault();
    const link = links[Math.max(0, Math.min(links.length - 1, next()))];
    links[now].setAttribute("tabindex", "-1");
    link.setAttribute("tabindex", "0");
    link.focus();
  });
}

// ---- Figures

function column_of(table, key) {
  return table.columns.find(column => column.key === key);
}

/// A line across the figure at the number that every row of the case has: a tolerance, a budget.
function draw_line(svg, frame, scale, vertical, value, label) {
  if (!usable(value) || value < scale.low || value > scale.high) return;
  const at = scale.at(value);
  const ends =
      vertical ? {x1: at, x2: at, y1: frame.top, y2: frame.bottom} : {x1: frame.left, x2: frame.right, y1: at, y2: at};
  const words = vertical ? {x: at - 5, y: frame.top + 13, "text-anchor": "end"} : {x: frame.left + 6, y: at - 5};
  svg.append(drawn("line", {class: "bound", ...ends}), drawn("text", {class: "bound", ...words}, label));
}

/// The times that shares of the frames exceed.
function tail_points(figure, table, rows) {
  const column = column_of(table, figure.shares.key);
  return rows.flatMap(row => value_of(row, column).split(" ").filter(Boolean).map((time, k) => ({
    row,
    x: 1e3 * Number(time),
    y: 100 * figure.shares.of[k],
    shown: true
  })));
}

function points_of(figure, table, rows) {
  if (figure.shares) return tail_points(figure, table, rows);
  const x = column_of(table, figure.x), y = column_of(table, figure.y);
  return rows.map(row => {
    const across = Math.abs(value_of(row, x)), up = Math.abs(value_of(row, y));
    return {
      row,
      x: across,
      y: up,
      lost: figure.strip && usable(across) && !usable(up),
      shown: usable(across) && usable(up)
    };
  });
}

function draw_scatter(figure, table, rows, plot, width) {
  const points = points_of(figure, table, rows);
  const shown = points.filter(point => point.shown), lost = points.filter(point => point.lost);
  const rest = points.length - shown.length - lost.length;
  const notes = [];
  if (lost.length) notes.push(counted(lost.length, "row", "rows") + " without an error in the grey strip");
  if (rest) notes.push(counted(rest, "row has", "rows have") + " no mark: a number is missing, zero or unbounded");
  plot.note.textContent = notes.join("; ");
  if (!shown.length) return element("p", {class: "none"}, "No row has a mark here.");
  const strip = lost.length ? 24 : 0;
  const height = Math.round(Math.max(270, Math.min(460, 0.62 * width)));
  const frame = {left: 62, right: width - 14, top: 10 + strip, bottom: height - 46};
  const svg = drawn("svg", {
    class: "figure",
    viewBox: `0 0 ${width} ${height}`,
    role: "group",
    "aria-label": figure.title + ", " + rows.length + " rows; arrow keys move between marks"
  });
  const line_values = figure.lines.map(line => value_of(rows[0], column_of(table, line.key)));
  const with_lines = axis => line_values.filter((value, k) => figure.lines[k].axis === axis && usable(value));
  let xs = [...shown.map(point => point.x), ...lost.map(point => point.x), ...with_lines("x")];
  let ys = [...shown.map(point => point.y), ...with_lines("y")];
  if (figure.diagonal) xs = ys = [...xs, ...ys];
  const x = logarithmic(xs, frame.left, frame.right), y = logarithmic(ys, frame.bottom, frame.top);
  if (strip)
    svg.append(
        drawn("rect", {class: "strip", x: frame.left, y: 6, width: frame.right - frame.left, height: strip - 4}));
  draw_axes(svg, x, y, frame, figure.labels);
  if (figure.diagonal)
    svg.append(drawn("line", {class: "bound", x1: frame.left, y1: frame.bottom, x2: frame.right, y2: frame.top}));
  figure.lines.forEach(
      (line, k) => draw_line(svg, frame, line.axis === "x" ? x : y, line.axis === "x", line_values[k], line.label));
  const by_series = new Map();
  for (const point of points)
    if (point.shown || point.lost) by_series.set(point.row[2], [...by_series.get(point.row[2]) ?? [], point]);
  for (const [series, members] of [...by_series].sort((a, b) => a[0] - b[0])) {
    const group = drawn("g", {class: "series", "data-series": series});
    const {colour, dash} = style_of(series);
    const path =
        members.filter(point => point.shown).map(point => x.at(point.x).toFixed(1) + "," + y.at(point.y).toFixed(1));
    if (figure.join && path.length > 1)
      group.append(drawn("polyline", {points: path.join(" "), style: `stroke:${colour}`, "stroke-dasharray": dash}));
    for (const point of members) {
      const at = {x: x.at(point.x), y: point.lost ? 6 + (strip - 4) / 2 : y.at(point.y)};
      group.append(link_to_row(
          table, point.row, plot, at,
          drawn(
              "g", {transform: `translate(${at.x.toFixed(1)} ${at.y.toFixed(1)})`},
              drawn("circle", {class: "hit", r: 10}), mark_path(series, 4.5))));
    }
    svg.append(group);
  }
  return svg;
}

/// The marks of a range by their names in figures.
const range_marks = {
  circle: shapes[0](5),
  bar: "M-1.5 -7h3v14h-3z",
  diamond: shapes[3](4.5)
};

/// A line of marks for each row that has at least two of the numbers.
function draw_ranges(figure, table, rows, plot, width) {
  const columns = figure.range.map(({key}) => column_of(table, key));
  const numbers = row => columns.map(column => value_of(row, column));
  const drawn_rows = rows.filter(row => numbers(row).filter(usable).length > 1);
  const left_out = rows.length - drawn_rows.length;
  plot.note.textContent = left_out ? counted(left_out, "row", "rows") + " " + figure.missing : "";
  if (!drawn_rows.length) return element("p", {class: "none"}, "No row has the numbers.");
  // Names stand beside the frame where there is room, else above their lines.
  const names = 16 + 6.9 * Math.max(...drawn_rows.map(row => data.series[row[2]].label.length));
  const narrow = names > 0.42 * width, step = narrow ? 42 : 26;
  const frame = {left: narrow ? 14 : names, right: width - 16, top: 24, bottom: 24 + step * drawn_rows.length + 6};
  const height = frame.bottom + 46;
  const svg = drawn("svg", {
    class: "figure wide",
    viewBox: `0 0 ${width} ${height}`,
    role: "group",
    "aria-label": figure.title + ", " + drawn_rows.length + " rows; arrow keys move between marks"
  });
  const bounds = figure.lines.map(line => value_of(drawn_rows[0], column_of(table, line.key)));
  const x = logarithmic([...drawn_rows.flatMap(numbers), ...bounds].filter(usable), frame.left, frame.right);
  draw_axes(svg, x, null, frame, figure.labels);
  figure.lines.forEach((line, k) => draw_line(svg, {...frame, top: 4}, x, true, bounds[k], line.label));
  drawn_rows.forEach((row, k) => {
    const y = frame.top + step * k + (narrow ? 30 : 15);
    const name = narrow ? {x: frame.left + 4, y: y - 12} : {x: frame.left - 8, y: y + 4, "text-anchor": "end"};
    svg.append(range_of(figure, table, row, plot, numbers(row).map(value => usable(value) ? x.at(value) : null), y, [
      drawn("rect", {class: "hit", x: 0, y: y - (narrow ? 26 : 13), width, height: step}),
      drawn("text", {class: is_recommended(table, row) ? "tick chosen" : "tick", ...name}, data.series[row[2]].label)
    ]));
  });
  return svg;
}

function is_recommended(table, row) {
  return value_of(row, column_of(table, "verdict")) === "recommended";
}

/// @param at  where its numbers are; null: it does not have it
function range_of(figure, table, row, plot, at, y, under) {
  const {colour} = style_of(row[2]), known = at.filter(place => place !== null);
  const low = Math.min(...known), high = Math.max(...known);
  const marks = at.flatMap((place, k) => place === null ? [] : [drawn("path", {
    class: "mark",
    d: range_marks[figure.range[k].mark],
    transform: `translate(${place} ${y})`,
    style: `fill:${colour}`
  })]);
  return link_to_row(
      table, row, plot, {x: (low + high) / 2, y}, ...under,
      drawn("line", {class: "range", x1: low, x2: high, y1: y, y2: y, style: `stroke:${colour}`}), ...marks);
}

function swatch(series, joined) {
  return drawn(
      "svg",
      {width: joined ? 30 : 16, height: 14, viewBox: joined ? "-15 -7 30 14" : "-8 -7 16 14", "aria-hidden": "true"},
      ...joined ? [drawn("line", {
        x1: -15,
        x2: 15,
        y1: 0,
        y2: 0,
        style: `stroke:${style_of(series).colour};stroke-width:1.8`,
        "stroke-dasharray": style_of(series).dash
      })] :
                  [],
      mark_path(series, 4.5));
}

/// Where there are more curves than a figure can show, those with a run that no other run beats in both numbers.
function hidden_at_first(figure, table, rows) {
  const members = new Set(rows.map(row => row[2]));
  if (!figure.best || members.size <= 16) return [];
  const [x, y] = figure.best.map(key => column_of(table, key));
  const points = rows.map(row => ({series: row[2], x: value_of(row, x), y: value_of(row, y)}))
                     .filter(point => usable(point.x) && usable(point.y));
  if (points.length === 0) return [];
  points.sort((a, b) => a.x - b.x || a.y - b.y);
  const best = new Set();
  let least = Infinity;
  for (const point of points)
    if (point.y < least) {
      least = point.y;
      best.add(point.series);
    }
  return [...members].filter(series => !best.has(series));
}

function key_of_ranges(figure) {
  return figure.range.map(({label, mark}) => element(
      "span", {},
      drawn(
          "svg", {width: 18, height: 16, viewBox: "-9 -8 18 16", "aria-hidden": "true"},
          drawn("path", {d: range_marks[mark], class: "plain"})),
      label));
}

/// Buttons that hide and show curves.
function make_legend(figure, rows, hidden, redraw) {
  const legend = element("div", {class: "legend", role: "group", "aria-label": "Shown"});
  // The rows of ranges have their names beside them.
  if (figure.range) {
    legend.append(...key_of_ranges(figure));
    return legend;
  }
  const members = [...new Set(rows.map(row => row[2]))].sort((a, b) => hidden.has(a) - hidden.has(b) || a - b);
  if (members.length < 2) {
    legend.append(element("span", {}, swatch(members[0], figure.join), data.series[members[0]].label));
    return legend;
  }
  const toggles = members.map(series => {
    const toggle = button(
        "", () => change(() => hidden.delete(series) || hidden.add(series)), {class: "toggle", "data-series": series});
    toggle.append(swatch(series, figure.join));
    toggle.append(data.series[series].label);
    return toggle;
  });
  const tell = () => {
    for (const toggle of toggles)
      toggle.setAttribute("aria-pressed", String(!hidden.has(Number(toggle.dataset.series))));
  };
  const change = how => {
    how();
    redraw();
    tell();
  };
  if (members.length > 4)
    legend.append(
        button("All", () => change(() => hidden.clear())),
        button("None", () => change(() => members.forEach(series => hidden.add(series)))));
  legend.append(...toggles);
  tell();
  if (hidden.size > 0)
    legend.prepend(element(
        "p", {class: "note"},
        `At first ${members.length - hidden.size} of ${
            members.length} curves are shown: those with a run that no other run beats in both error and time.`));
  return legend;
}

function make_figure(figure, holder) {
  const table = data.tables.find(each => each.id === figure.table);
  // A figure of times has rows of the processor or of devices.
  const own = figure.on_device === undefined ?
      table.rows :
      table.rows.filter(row => (value_of(row, column_of(table, "device")) !== "") === figure.on_device);
  const cases = [...new Set(own.map(row => row[3]))];
  const rows_of = which => own.filter(row => which < 0 || row[3] === which);
  let chosen = figure.whole ? -1 : cases[0], last_width = 0;
  let hidden = new Set(hidden_at_first(figure, table, rows_of(chosen)));
  const made = element("figure", {class: "plot"}, element("figcaption", {}, figure.title));
  const tools = element("div", {class: "tools"});
  if (cases.length > 1) {
    const choice = element("select");
    if (figure.whole) choice.append(element("option", {value: -1}, "all"));
    for (const each of cases) choice.append(element("option", {value: each}, data.cases[each]));
    choice.addEventListener("change", () => {
      chosen = Number(choice.value);
      hidden = new Set(hidden_at_first(figure, table, rows_of(chosen)));
      redraw(true);
    });
    tools.append(element("label", {}, "Problem ", choice));
  }
  const body = element("div"), printed = element("div", {class: "printed"});
  made.append(tools, body, printed, element("p", {class: "words-of-figure"}, figure.words));
  holder.append(made);

  /// A drawing with its legend, note and tip in `place`.
  function draw_into(place, which, width, without) {
    const plot = {
      box: element("div", {class: "drawing"}),
      tip: element("div", {class: "tip", "aria-hidden": "true", hidden: ""}),
      note: element("p", {class: "note"}),
      targets: new Map()
    };
    const rows = rows_of(which).filter(row => !without.has(row[2]));
    const draw = figure.range ? draw_ranges : draw_scatter;
    const svg =
        rows.length ? draw(figure, table, rows, plot, width) : element("p", {class: "none"}, "Every method is hidden.");
    plot.box.append(svg, plot.tip);
    place.append(plot.box, plot.note);
    follow_marks(plot);
    walk_by_arrows(svg);
  }
  function redraw(with_legend) {
    const width = Math.max(300, Math.floor(body.clientWidth));
    last_width = width;
    const legend = with_legend || !body.firstChild ? make_legend(figure, rows_of(chosen), hidden, () => redraw(false)) :
                                                     body.firstChild;
    while (body.lastChild && body.lastChild !== legend) body.lastChild.remove();
    if (legend.parentNode !== body) body.replaceChildren(legend);
    draw_into(body, chosen, width, hidden);
  }
  redraw(true);
  if (window.ResizeObserver)
    new ResizeObserver(() => {
      // In the next frame: a drawing inside the observer would resize what it observes.
      if (Math.abs(body.clientWidth - last_width) > 2 && body.clientWidth >= 300)
        requestAnimationFrame(() => redraw(false));
    }).observe(body);
  figure.print = on => {
    made.classList.toggle("printing", on);
    printed.replaceChildren();
    if (on)
      for (const which of figure.whole || cases.length === 1 ? [chosen] : cases) {
        const part = element("div", {class: "part"});
        printed.append(part);
        if (cases.length > 1) part.append(element("p", {class: "case"}, which < 0 ? "all" : data.cases[which]));
        const without = which === chosen ? hidden : new Set(hidden_at_first(figure, table, rows_of(which)));
        part.append(make_legend(figure, rows_of(which).filter(row => !without.has(row[2])), new Set(), () => {}));
        draw_into(part, which, figure.range ? 960 : 700, without);
      }
  };
}
