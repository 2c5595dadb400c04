// Of pages with a body: turns, moves and colours each `figure.scene` of `scene_html`.
"use strict";

// ---- Drawing, when something has changed

function fit_canvas(view) {
  const {canvas} = view, dots = Math.min(window.devicePixelRatio || 1, 2);
  const width = Math.max(1, Math.round(canvas.clientWidth * dots));
  const height = Math.max(1, Math.round(canvas.clientHeight * dots));
  if (canvas.width !== width) canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
  view.dots = dots;
}

function draw(view) {
  view.asked = false;
  if (!view.graphics || view.canvas.clientWidth === 0) return;
  const {gl} = view.graphics;
  fit_canvas(view);
  if (view.moved) {
    place(view);
    fill_corners(view);
    write_state(view);
  }
  const camera = camera_of(view), style = getComputedStyle(view.stage);
  const ink = components(style.color), ground = components(style.backgroundColor);
  gl.viewport(0, 0, view.canvas.width, view.canvas.height);
  gl.clearColor(0, 0, 0, 0);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.enable(gl.DEPTH_TEST);
  gl.depthFunc(gl.LEQUAL);
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  draw_surface(view, camera, ink);
  if (view.mesh) draw_edges(view, camera);
  if (view.body.held.length) draw_held(view, camera, ink, ground);
  if (is_mode(view) && mode_of(view).owner.length) draw_owner(view, camera);
  view.moved = false;
  write_scale(view, camera.scale);
}

/// @param moved  the shape or its values have changed, not only the view
function redraw(view, moved = false) {
  view.moved ||= moved;
  if (view.asked) return;
  view.asked = true;
  requestAnimationFrame(now => {
    if (view.playing) advance(view, now);
    draw(view);
    if (view.playing && view.on_screen && view.graphics) redraw(view, true);
  });
}

/// Seconds in which Play shows the motion.
function seconds_of(motion) {
  return Math.min(12, Math.max(3, motion.t[motion.t.length - 1] - motion.t[0]));
}

/// The place of `time` between the frames.
function frame_at(t, time) {
  const next = t.findIndex(each => each > time);
  return next < 0 ? t.length - 1 : next === 0 ? 0 : next - 1 + (time - t[next - 1]) / (t[next] - t[next - 1]);
}

function advance(view, now) {
  const passed = Math.min(0.1, (now - (view.last ?? now)) / 1e3);
  view.last = now;
  view.moved = true;
  if (is_mode(view)) {
    view.phase = (view.phase + 2 * Math.PI * passed / mode_seconds) % (2 * Math.PI);
    return;
  }
  const {t} = view.body.motion, end = t.length - 1;
  view.frame = frame_at(t, view.t + (t[end] - t[0]) * passed / seconds_of(view.body.motion));
  if (view.frame === end) play(view, false);
}

function play(view, on) {
  const end = view.shown === "motion" ? view.body.motion.t.length - 1 : 0;
  if (on && view.shown === "motion" && (view.untouched || view.frame >= end)) {
    view.frame = 0;
    view.t = view.body.motion.t[0];
  }
  view.untouched = false;
  view.playing = on;
  view.last = null;
  view.parts.play.textContent = on ? "Pause" : "Play";
  redraw(view, true);
}

// ---- Words

function number_text(value, digits = 3) {
  if (value === 0) return "0";
  const size = Math.abs(value), rounded = Number(value.toPrecision(digits));
  const text = size >= 1e6 || size < 1e-4 ? rounded.toExponential() : String(rounded);
  return text.replace("-", "\u2212");
}

/// The unit in which `largest` is between a hundredth and a thousand, where there is one.
function unit_for(largest, units) {
  return units.find(([factor]) => largest / factor < 1000) ?? units[units.length - 1];
}
const lengths = [[1e-6, "\u00b5m"], [1e-3, "mm"], [1, "m"]], millimetres = lengths.slice(1);
const energies = [[1e-3, "mJ/m\u00b3"], [1, "J/m\u00b3"], [1e3, "kJ/m\u00b3"], [1e6, "MJ/m\u00b3"]];
const times = [[1e-6, "\u00b5s"], [1e-3, "ms"], [1, "s"]];

const length_unit = largest => largest > 0 && largest < 1e-5 ? lengths[0] : unit_for(largest, millimetres);
const energy_unit = largest => unit_for(largest, largest < 1 ? energies : energies.slice(1));
const time_unit = largest => largest >= 0.1 ? times[2] : unit_for(largest, times);

const in_unit = (value, [factor, name], digits = 3) => number_text(value / factor, digits) + "\u00a0" + name;

/// `value` with as many decimals as `step` has.
function with_decimals(value, step) {
  return value.toFixed(Math.min(6, Math.max(0, Math.ceil(1e-9 - Math.log10(step))))).replace("-", "\u2212");
}

function time_words(view) {
  const {t, largest} = view.body.motion, [factor, name] = time_unit(t[t.length - 1]);
  const length = length_unit(largest), top = largest / length[0] || 1;
  const size = with_decimals(view.largest / length[0], 10 ** (Math.floor(Math.log10(top)) - 1)) + "\u00a0" + length[1];
  const step = (t[t.length - 1] - t[0]) / (t.length - 1) / factor;
  if (!(step > 0)) return `Largest displacement ${size}`;
  return `t = ${with_decimals(view.t / factor, step)}\u00a0${name}, largest displacement ${size}`;
}

/// What moves: the time, or the scale of the mode.
function write_state(view) {
  const {time, slider} = view.parts;
  if (view.shown !== "motion") return;
  time.textContent = time_words(view);
  slider.value = Math.round(view.frame);
  slider.setAttribute("aria-valuetext", time.textContent);
}

function mode_words(mode) {
  const frequency = mode.frequency > 0 ? `Frequency ${number_text(mode.frequency, 4)}\u00a0Hz, period ` +
          in_unit(1 / mode.frequency, unit_for(1 / mode.frequency, times)) + "." :
                                         "Frequency 0\u00a0Hz.";
  const sentence = text => text === "" || /[.!?]$/.test(text) ? text : text + ".";
  const first = mode.words.charAt(0).toUpperCase() + mode.words.slice(1);
  const owner = mode.owner_words.charAt(0).toUpperCase() + mode.owner_words.slice(1);
  return {first: sentence(first), frequency, owner: sentence(owner)};
}

function write_words(view) {
  const {words} = view.parts;
  if (!is_mode(view)) {
    const {motion} = view.body;
    const ratio = motion ? seconds_of(motion) / (motion.t[motion.t.length - 1] - motion.t[0]) : 1;
    const speed = ratio > 1.05 ? number_text(ratio, 2) + " times slower than the motion" :
        ratio < 0.95           ? number_text(1 / ratio, 2) + " times faster than the motion" :
                                 "at the speed of the motion";
    words.replaceChildren(motion && motion.t.length > 1 ? `Played ${speed}.` : "");
    return;
  }
  const {first, frequency, owner} = mode_words(mode_of(view));
  const key = mode_of(view).owner.length && owner ? [make("span", {className: "scene-owner"}), owner] : [owner];
  words.replaceChildren(
      make("b", {}, first), " ", frequency, " ", ...key,
      " Its largest displacement is drawn as a tenth of the body's diagonal.");
}

/// Round numbers from 0 to `top`, about four.
function ticks_to(top) {
  const rough = top / 4, power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find(each => each * power >= rough);
  return Array.from({length: Math.floor(top / step * (1 + 1e-9)) + 1}, (_, k) => k * step);
}

function write_bar(view) {
  const {bar} = view.parts, {motion} = view.body;
  bar.hidden = view.shown === "rest";
  if (bar.hidden) return;
  const of = shows_energy(view) ? ["elastic energy density", motion.energy_top, energy_unit(motion.energy_top)] :
      is_mode(view)             ? ["displacement, relative to the largest", 1, [1, ""]] :
                                  ["displacement", motion.largest || 1e-3, length_unit(motion.largest || 1e-3)];
  const [name, top, [factor, unit]] = of, cut = shows_energy(view) && motion.energy_is_cut;
  const ticks = ticks_to(top / factor).map(value => {
    const share = value * factor / top, tick = make("span", {}, number_text(value));
    tick.style.left = 100 * share + "%";
    return tick;
  });
  const beyond = cut ? ` (above ${in_unit(top, of[2])} in the last colour)` : "";
  bar.firstChild.textContent = name + (unit ? ` [${unit}]` : "") + beyond;
  bar.lastChild.replaceChildren(...ticks);
}

/// A length in round numbers, of at most 160 pixels, and 64 at least.
function write_scale(view, pixels) {
  const most = 160 / pixels, power = 10 ** Math.floor(Math.log10(most));
  const length = power * [5, 2, 1].find(each => each * power <= most);
  const {scale} = view.parts, text = in_unit(length, length < 1e-3 ? lengths[0] : length < 1 ? lengths[1] : lengths[2]);
  scale.style.width = length * pixels + "px";
  if (scale.textContent !== text) scale.textContent = text;
}

// ---- Controls

function make(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

function select_of(name, choices, chosen, act) {
  const select = make("select", {}, ...choices.map(([value, text]) => make("option", {value}, text)));
  select.value = chosen;
  select.addEventListener("change", () => act(select.value));
  return make("label", {}, name + " ", select);
}

function push(text, act, label = "") {
  const made = make("button", {type: "button"}, text);
  if (label) made.setAttribute("aria-label", label), made.title = label;
  made.addEventListener("click", act);
  return made;
}

const choices_of = body =>
    [...(body.motion ? [["motion", body.motion.t.length > 1 ? "motion" : "deformed shape"]] : []),
     ...body.modes.map((mode, k) => [String(k), `${mode.words}, ${number_text(mode.frequency)} Hz`])];

const is_calm = () => window.matchMedia("(prefers-reduced-motion: reduce)").matches;

/// What is possible for what is shown, and its words.
function set_shown(view, shown) {
  const {parts, body} = view, moves = shown === "motion" && body.motion.t.length > 1;
  view.shown = shown;
  view.phase = Math.PI / 2;
  view.reach = reach_of(view);
  parts.row.hidden = shown === "rest";
  parts.play.hidden = !moves && !is_mode(view);
  parts.slider.hidden = !moves;
  parts.time.hidden = shown !== "motion";
  parts.factor.hidden = shown !== "motion";
  parts.colour.hidden = shown !== "motion" || !body.motion.energies;
  write_words(view);
  write_bar(view);
  play(view, false);
}

function show(view, shown) {
  set_shown(view, shown);
  if (!is_mode(view) || is_calm()) return;
  view.phase = 0;
  play(view, true);
}

function choices_row(view) {
  const {parts} = view, choices = choices_of(view.body);
  parts.show = select_of("Show", choices, view.shown, value => show(view, value));
  parts.show.hidden = choices.length < 2;
  parts.colour =
      select_of("Colour", [["displacement", "displacement"], ["energy", "energy density"]], view.colour, value => {
        view.colour = value;
        write_bar(view);
        redraw(view, true);
      });
  parts.factor = select_of("Deformation", [1, 2, 5, 10, 20].map(x => [x, "\u00d7" + x]), view.factor, value => {
    view.factor = Number(value);
    view.reach = reach_of(view);
    redraw(view, true);
  });
  const box = make("input", {type: "checkbox", checked: view.mesh});
  box.addEventListener("change", () => {
    view.mesh = box.checked;
    redraw(view);
  });
  return make(
      "div", {className: "scene-tools"}, parts.show, parts.colour, parts.factor, make("label", {}, box, " Mesh"));
}

function play_row(view) {
  const {parts} = view, {motion} = view.body;
  parts.play = push("Play", () => play(view, !view.playing));
  parts.slider = make("input", {type: "range", min: 0, max: motion ? motion.t.length - 1 : 1, step: 1});
  parts.slider.setAttribute("aria-label", "Time");
  parts.slider.addEventListener("input", () => {
    play(view, false);
    view.frame = Number(parts.slider.value);
    redraw(view, true);
  });
  parts.time = make("span", {className: "scene-time"});
  return parts.row = make("div", {className: "scene-play"}, parts.play, parts.slider, parts.time);
}

function stage_of(view) {
  const {parts, canvas} = view;
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "application");
  canvas.setAttribute(
      "aria-label",
      `${view.body.title || "Body"} in three dimensions. Drag or arrow keys turn it, ` +
          "plus and minus zoom, Home resets the view, Space plays.");
  parts.scale = make("span", {className: "scene-scale"});
  const key = make("span", {className: "scene-key", hidden: !view.body.held.length}, view.body.held_as || "fixed");
  const buttons = make(
      "div", {className: "scene-buttons"}, push("+", () => zoom(view, 1.25), "Zoom in"),
      push("\u2212", () => zoom(view, 0.8), "Zoom out"), push("Reset", () => reset(view), "Reset the view"));
  return view.stage = make("div", {className: "scene-stage"}, canvas, buttons, key, parts.scale);
}

function bar_of(view) {
  const bar = make(
      "div", {className: "scene-bar"}, make("span"), make("div", {className: "scene-colours"}),
      make("div", {className: "scene-ticks"}));
  bar.children[1].style.background = `linear-gradient(to right, ${view.colours.join(",")})`;
  return view.parts.bar = bar;
}

// ---- Turning and zooming

function turn(view, right, up) {
  view.turn = [view.turn[0] + right, Math.min(Math.PI / 2, Math.max(-Math.PI / 2, view.turn[1] + up))];
  redraw(view);
}

function pan(view, right, down) {
  view.shift = [view.shift[0] + right, view.shift[1] + down];
  redraw(view);
}

function zoom(view, factor) {
  const before = view.zoom;
  view.zoom = Math.min(40, Math.max(0.25, before * factor));
  view.shift = view.shift.map(x => x * view.zoom / before);
  redraw(view);
}

function reset(view) {
  Object.assign(view, {turn: turn_of(view.towards), zoom: 1, shift: [0, 0]});
  redraw(view);
}

function follow_keys(view) {
  const step = Math.PI / 36;
  const acts = {
    ArrowLeft: far => far ? pan(view, -20, 0) : turn(view, step, 0),
    ArrowRight: far => far ? pan(view, 20, 0) : turn(view, -step, 0),
    ArrowUp: far => far ? pan(view, 0, -20) : turn(view, 0, -step),
    ArrowDown: far => far ? pan(view, 0, 20) : turn(view, 0, step),
    "+": () => zoom(view, 1.25),
    "=": () => zoom(view, 1.25),
    "-": () => zoom(view, 0.8),
    Home: () => reset(view),
    " ": () => view.parts.play.hidden || play(view, !view.playing)
  };
  view.canvas.addEventListener("keydown", event => {
    if (event.ctrlKey || event.metaKey || event.altKey || !Object.hasOwn(acts, event.key)) return;
    event.preventDefault();
    acts[event.key](event.shiftKey);
  });
}

/// One pointer turns, with Shift it shifts; two zoom and shift.
function follow_pointers(view) {
  const {canvas} = view, down = new Map();
  const spread = ([a, b]) => Math.hypot(a.x - b.x, a.y - b.y) || 1;
  canvas.addEventListener("pointerdown", event => {
    if (event.button !== 0) return;
    down.set(event.pointerId, {x: event.clientX, y: event.clientY});
    if (event.isTrusted) canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", event => {
    const last = down.get(event.pointerId);
    if (!last) return;
    const before = spread([...down.values(), last]), x = event.clientX - last.x, y = event.clientY - last.y;
    Object.assign(last, {x: event.clientX, y: event.clientY});
    if (down.size > 1) {
      pan(view, x / 2, y / 2);
      zoom(view, spread([...down.values()]) / before);
    } else if (event.shiftKey)
      pan(view, x, y);
    else
      turn(view, -0.008 * x, 0.008 * y);
  });
  for (const name of ["pointerup", "pointercancel", "lostpointercapture"])
    canvas.addEventListener(name, event => down.delete(event.pointerId));
  canvas.addEventListener("wheel", event => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    zoom(view, Math.exp(-0.002 * event.deltaY));
  }, {passive: false});
}

/// The view changes with the size of the canvas and the theme; nothing moves off screen.
function follow_page(view) {
  new ResizeObserver(() => redraw(view)).observe(view.canvas);
  const themes = {attributes: true, attributeFilter: ["data-theme", "class", "style"]};
  new MutationObserver(() => redraw(view)).observe(document.documentElement, themes);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => redraw(view));
  new IntersectionObserver(entries => {
    view.on_screen = entries[entries.length - 1].isIntersecting;
    view.last = null;
    if (view.on_screen) redraw(view);
  }).observe(view.canvas);
}

// ---- The figure

/// The picture stands in for the view where nothing can be drawn.
function stand_in(view, words) {
  view.graphics = null;
  view.figure.classList.remove("scene-live");
  view.note.textContent = words;
}

function come_alive(view) {
  view.graphics = graphics_of(view);
  if (!view.graphics)
    return stand_in(view, "This browser offers no WebGL: a picture is shown instead of the body that turns.");
  view.figure.classList.add("scene-live");
  view.note.textContent = "";
  redraw(view, true);
}

function view_of(figure) {
  const body = read_body(figure.querySelector("script").textContent), count = body.points.length / 3;
  body.edge = mean_length(body.points, body.source, body.edges);
  const towards = figure.dataset.towards.split(" ").map(Number), {motion} = body;
  return {
    figure,
    body,
    towards,
    canvas: document.createElement("canvas"),
    note: make("p", {className: "scene-note"}),
    colours: figure.dataset.colours.split(" "),
    parts: {},
    at: new Float32Array(3 * count),
    values: new Float32Array(count),
    corners: new Float32Array(7 * body.source.length),
    shown: motion         ? "motion" :
        body.modes.length ? "0" :
                            "rest",
    colour: "displacement",
    frame: motion ? motion.largest_frame : 0,
    factor: 1,
    mesh: body.triangles.length <= 3 * 4000,
    turn: turn_of(towards),
    zoom: 1,
    shift: [0, 0],
    on_screen: true,
    untouched: true
  };
}

/// @param figure  of `scene_html`
function make_scene(figure) {
  const view = view_of(figure), {canvas} = view;
  const shown = make("div", {className: "scene-view"}, choices_row(view), stage_of(view), play_row(view), bar_of(view));
  view.parts.words = make("p", {className: "scene-words"});
  shown.append(view.parts.words);
  figure.querySelector(".scene-picture").before(shown);
  figure.querySelector(".scene-picture").append(view.note);
  set_shown(view, view.shown);
  view.untouched = true;
  follow_keys(view);
  follow_pointers(view);
  follow_page(view);
  canvas.addEventListener("webglcontextlost", event => {
    event.preventDefault();
    stand_in(view, "The graphics card was lost: a picture is shown until it is back.");
  });
  canvas.addEventListener("webglcontextrestored", () => come_alive(view));
  come_alive(view);
}

for (const figure of document.querySelectorAll("figure.scene")) make_scene(figure);
