// Of pages with a body: its shape as it moves, and its picture with WebGL 1. `scene_script` puts it before
// body_scene.js.
"use strict";

// ---- The body

// Share of the diagonal of the body that a mode moves it, as in body_scene.cpp.
const mode_share = 0.1;
const mode_seconds = 2;      // of a cycle
const smooth_cosine = 0.64;  // triangles that meet at less than 50 degrees look rounded

/// base64 of little-endian numbers, as every processor with a browser has them.
function numbers_of(text, Numbers) {
  return new Numbers(Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer);
}

function length_at(vectors, i) {
  return Math.hypot(vectors[3 * i], vectors[3 * i + 1], vectors[3 * i + 2]);
}

function longest(vectors) {
  let most = 0;
  for (let i = 0; 3 * i < vectors.length; ++i) most = Math.max(most, length_at(vectors, i));
  return most;
}

/// Middle of the box round the points, and its diagonal.
function box_of(points) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  points.forEach((x, i) => {
    low[i % 3] = Math.min(low[i % 3], x);
    high[i % 3] = Math.max(high[i % 3], x);
  });
  return {middle: low.map((x, k) => (x + high[k]) / 2), diagonal: Math.hypot(...low.map((x, k) => high[k] - x))};
}

function read_motion(json) {
  const frames = json.displacements.map(text => numbers_of(text, Int16Array));
  const unit = json.largest / 32767, lengths = frames.map(frame => unit * longest(frame));
  const motion = {t: json.t, unit, frames, largest: Math.max(...lengths), energies: null};
  motion.largest_frame = lengths.indexOf(motion.largest);
  if (!json.energy_density) return motion;
  motion.energies = json.energy_density.map(text => numbers_of(text, Int16Array));
  motion.energy_unit = json.energy_largest / 32767;
  motion.energy_top = top_of(motion.energies) * motion.energy_unit;
  motion.energy_is_cut = motion.energy_top < 0.999 * json.energy_largest;
  return motion;
}

/// The upper end of the colours: the largest value, or the 99th percentile where peaks would leave the rest
/// pale.
function top_of(frames) {
  const counts = new Uint32Array(32768);
  let all = 0;
  for (const frame of frames)
    for (const x of frame)
      if (x > 0) counts[x] += 1, all += 1;
  let top = 0, below = 0, largest = 0;
  for (let x = 1; x < counts.length; ++x) {
    if (!counts[x]) continue;
    if (below < 0.99 * all) top = x;
    below += counts[x];
    largest = x;
  }
  return 2 * top < largest ? top : Math.max(largest, 1);
}

function read_mode(json, diagonal) {
  const shape = Float32Array.from(numbers_of(json.shape, Int16Array)), most = Math.max(longest(shape), 1);
  const values = Float32Array.from({length: shape.length / 3}, (_, i) => length_at(shape, i) / most);
  for (let i = 0; i < shape.length; ++i) shape[i] *= mode_share * diagonal / most;
  return {...json, shape, values};
}

function read_body(text) {
  const json = JSON.parse(text), points = numbers_of(json.points, Float32Array);
  const Indices = points.length / 3 <= 65536 ? Uint16Array : Int32Array;
  const body = {title: json.title, points, ...box_of(points)};
  body.held = numbers_of(json.held, Indices);
  body.motion = json.motion ? read_motion(json.motion) : null;
  body.modes = json.modes.map(mode => read_mode(mode, body.diagonal));
  return {...body, ...split_at_creases(points, numbers_of(json.triangles, Indices))};
}

/// Twice the area of the triangle of the points at 3 `a`, 3 `b`, 3 `c`, as its normal.
function normal_of(x, a, b, c) {
  const ux = x[b] - x[a], uy = x[b + 1] - x[a + 1], uz = x[b + 2] - x[a + 2];
  const vx = x[c] - x[a], vy = x[c + 1] - x[a + 1], vz = x[c + 2] - x[a + 2];
  return [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/// Corners: points of which those at creases are there several times, once for each smooth part of the
/// surface. `source` has the point of each corner, `triangles` three corners each, `edges` two.
function split_at_creases(points, triangles) {
  const parts = new Map(), source = [], corners = new Uint32Array(triangles.length);
  for (let k = 0; k < triangles.length; k += 3) {
    const normal = normal_of(points, 3 * triangles[k], 3 * triangles[k + 1], 3 * triangles[k + 2]);
    for (let j = k; j < k + 3; ++j) {
      const here = parts.get(triangles[j]) ?? parts.set(triangles[j], []).get(triangles[j]);
      let part =
          here.find(each => dot(each.sum, normal) >= smooth_cosine * Math.hypot(...each.sum) * Math.hypot(...normal));
      if (!part) {
        part = {sum: [0, 0, 0], corner: source.length};
        source.push(triangles[j]);
        here.push(part);
      }
      part.sum = part.sum.map((x, i) => x + normal[i]);
      corners[j] = part.corner;
    }
  }
  return {source: Uint32Array.from(source), triangles: corners, edges: edges_of(triangles, corners)};
}

function edges_of(triangles, corners) {
  const seen = new Set(), edges = [];
  for (let k = 0; k < triangles.length; ++k) {
    const next = k % 3 === 2 ? k - 2 : k + 1;
    const key = Math.min(triangles[k], triangles[next]) * 2 ** 26 + Math.max(triangles[k], triangles[next]);
    if (seen.has(key)) continue;
    seen.add(key);
    edges.push(corners[k], corners[next]);
  }
  return Uint32Array.from(edges);
}

/// The mean length of edges [m].
function mean_length(points, source, edges) {
  let sum = 0;
  for (let k = 0; k < edges.length; k += 2) {
    const a = 3 * source[edges[k]], b = 3 * source[edges[k + 1]];
    sum += Math.hypot(points[a] - points[b], points[a + 1] - points[b + 1], points[a + 2] - points[b + 2]);
  }
  return 2 * sum / edges.length;
}

// ---- What is shown: the shape and its values

const is_mode = view => view.shown !== "motion" && view.shown !== "rest";
const mode_of = view => view.body.modes[view.shown];
const shows_energy = view => view.shown === "motion" && view.colour === "energy";

/// Fills `at`, the points where they are drawn, and `values`, 0 to 1 of each point, or -1 for grey.
function place(view) {
  const {body, at, values} = view;
  at.set(body.points);
  if (view.shown === "motion") return place_motion(view);
  if (!is_mode(view)) return values.fill(-1);
  const {shape} = mode_of(view), sine = Math.sin(view.phase);
  for (let i = 0; i < at.length; ++i) at[i] += sine * shape[i];
  values.set(mode_of(view).values);
}

function place_motion(view) {
  const {motion} = view.body, {at, values} = view;
  const a = Math.min(Math.floor(view.frame), motion.t.length - 1), b = Math.min(a + 1, motion.t.length - 1);
  const share = view.frame - a, first = motion.frames[a], second = motion.frames[b], {unit} = motion;
  const between = (p, q, i) => (1 - share) * p[i] + share * q[i];
  view.t = (1 - share) * motion.t[a] + share * motion.t[b];
  view.largest = 0;
  for (let i = 0; i < values.length; ++i) {
    let sum = 0;
    for (let k = 3 * i; k < 3 * i + 3; ++k) {
      const u = unit * between(first, second, k);
      at[k] += view.factor * u;
      sum += u * u;
    }
    const size = Math.sqrt(sum);
    view.largest = Math.max(view.largest, size);
    values[i] = motion.largest > 0 ? size / motion.largest : 0;
  }
  if (!shows_energy(view)) return;
  const p = motion.energies[a], q = motion.energies[b], energy = motion.energy_unit / motion.energy_top;
  for (let i = 0; i < values.length; ++i) values[i] = Math.max(0, energy * between(p, q, i));
}

/// How far the body reaches from its middle in everything that is shown: around its upright axis, and
/// upwards.
function reach_of(view) {
  const {body} = view, {points, middle} = body;
  const shapes = view.shown === "motion" ? body.motion.frames.map(frame => [frame, view.factor * body.motion.unit]) :
      is_mode(view)                      ? [[mode_of(view).shape, 1], [mode_of(view).shape, -1]] :
                                           [[points, 0]];
  let around = 0, up = 0;
  for (const [shape, factor] of shapes)
    for (let i = 0; i < points.length; i += 3) {
      const x = points[i] + factor * shape[i] - middle[0], y = points[i + 1] + factor * shape[i + 1] - middle[1];
      around = Math.max(around, x * x + y * y);
      up = Math.max(up, Math.abs(points[i + 2] + factor * shape[i + 2] - middle[2]));
    }
  return {around: Math.sqrt(around), up};
}

/// Position, normal and value of each corner, seven numbers each.
function fill_corners(view) {
  const {body, at, values, corners} = view, {source, triangles} = body;
  for (let i = 0; i < source.length; ++i) {
    const p = 3 * source[i], c = 7 * i;
    corners[c] = at[p], corners[c + 1] = at[p + 1], corners[c + 2] = at[p + 2];
    corners[c + 3] = corners[c + 4] = corners[c + 5] = 0;
    corners[c + 6] = values[source[i]];
  }
  for (let k = 0; k < triangles.length; k += 3) {
    const normal = normal_of(corners, 7 * triangles[k], 7 * triangles[k + 1], 7 * triangles[k + 2]);
    for (let j = k; j < k + 3; ++j)
      for (let i = 0; i < 3; ++i) corners[7 * triangles[j] + 3 + i] += normal[i];
  }
}

// ---- The camera: parallel lines stay parallel, z is up

const turn_of =
    towards => [Math.atan2(towards[1], towards[0]), Math.atan2(towards[2], Math.hypot(...towards.slice(0, 2)))];

/// Right, up and towards the viewer; pixels for each metre; clip coordinates as a matrix by columns.
function camera_of(view) {
  const [a, e] = view.turn, {around, up} = view.reach, {middle} = view.body;
  const axes = [
    [-Math.sin(a), Math.cos(a), 0],
    [-Math.sin(e) * Math.cos(a), -Math.sin(e) * Math.sin(a), Math.cos(e)],
    [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)],
  ];
  const width = view.canvas.clientWidth, height = view.canvas.clientHeight;
  const half = up * Math.cos(e) + around * Math.abs(Math.sin(e));
  const scale = view.zoom * 0.46 * Math.min(width / around, height / half);
  const scales = [2 * scale / width, 2 * scale / height, -0.95 / Math.hypot(around, up)];
  const shifts = [view.shift[0] * 2 / width, -view.shift[1] * 2 / height, 0];
  const matrix = [0, 1, 2].flatMap(column => [...axes.map((axis, row) => axis[column] * scales[row]), 0]);
  matrix.push(...axes.map((axis, row) => shifts[row] - scales[row] * dot(axis, middle)), 1);
  return {matrix, scale, turned: [0, 1, 2].flatMap(column => axes.map(axis => axis[column]))};
}

const clip_of =
    (m, x, i) => [0, 1].map(row => m[row] * x[i] + m[row + 4] * x[i + 1] + m[row + 8] * x[i + 2] + m[row + 12]);

// ---- WebGL

const surface_code = [
  `attribute vec3 position; attribute vec3 normal; attribute float value;
uniform mat4 seen; uniform mat3 turned;
varying vec3 facing; varying float share;
void main() {
  facing = turned * normal / max(length(normal), 1e-30);
  share = value;
  gl_Position = seen * vec4(position, 1.0);
}`,
  `precision mediump float;
uniform sampler2D colours; uniform float stops; uniform vec3 rim;
varying vec3 facing; varying float share;
const vec3 light = vec3(-0.415, 0.622, 0.664);
const vec3 middle = vec3(-0.227, 0.341, 0.912);
void main() {
  vec3 n = normalize(facing);
  if (!gl_FrontFacing) n = -n;
  vec3 colour = texture2D(colours, vec2((clamp(share, 0.0, 1.0) * (stops - 1.0) + 0.5) / stops, 0.5)).rgb;
  if (share < -0.5) colour = vec3(0.82);
  float lambert = clamp((dot(n, light) + 0.35) / 1.35, 0.0, 1.0);
  colour = colour * mix(0.6, 1.02, lambert) + 0.04 * pow(max(dot(n, middle), 0.0), 20.0);
  float edge = 1.0 - clamp(n.z, 0.0, 1.0);
  gl_FragColor = vec4(mix(colour, rim, 0.45 * edge * edge * edge), 1.0);
}`
];

const plain_code = [
  `attribute vec3 position;
uniform mat4 seen; uniform float size; uniform float nearer;
void main() {
  gl_Position = seen * vec4(position, 1.0);
  gl_Position.z -= nearer;
  gl_PointSize = size;
}`,
  `precision mediump float;
uniform vec4 colour; uniform vec4 border; uniform float round;
void main() {
  float far = length(gl_PointCoord - 0.5) * 2.0;
  if (round > 0.5 && far > 1.0) discard;
  vec4 shown = round > 0.5 && far > 0.62 ? border : colour;
  gl_FragColor = vec4(shown.rgb * shown.a, shown.a);
}`
];

function program_of(gl, code, attributes) {
  const program = gl.createProgram();
  code.forEach((text, k) => {
    const shader = gl.createShader(k === 0 ? gl.VERTEX_SHADER : gl.FRAGMENT_SHADER);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  });
  attributes.forEach((name, k) => gl.bindAttribLocation(program, k, name));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program) ?? "no program");
  const place = new Map();
  return {program, at: name => place.get(name) ?? place.set(name, gl.getUniformLocation(program, name)).get(name)};
}

function colour_texture(gl, colours) {
  const bytes =
      new Uint8Array(colours.flatMap(hex => [1, 3, 5].map(k => parseInt(hex.slice(k, k + 2), 16)).concat(255)));
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, colours.length, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
  for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, side, gl.CLAMP_TO_EDGE);
}

function index_buffer(gl, indices, corners) {
  const small = corners <= 65536, buffer = gl.createBuffer();
  if (!small && !gl.getExtension("OES_element_index_uint")) throw new Error("more than 65536 points");
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, small ? Uint16Array.from(indices) : indices, gl.STATIC_DRAW);
  return {buffer, count: indices.length, type: small ? gl.UNSIGNED_SHORT : gl.UNSIGNED_INT};
}

/// All that is on the graphics card, or null where there is none.
function graphics_of(view) {
  const gl = view.canvas.getContext("webgl", {antialias: true});
  if (!gl || gl.isContextLost()) return null;
  try {
    const corners = view.body.source.length;
    colour_texture(gl, view.colours);
    return {
      gl,
      surface: program_of(gl, surface_code, ["position", "normal", "value"]),
      plain: program_of(gl, plain_code, ["position"]),
      triangles: index_buffer(gl, view.body.triangles, corners),
      edges: index_buffer(gl, view.body.edges, corners),
      corners: gl.createBuffer(),
      others: gl.createBuffer()
    };
  } catch {
    return null;
  }
}

/// Red, green and blue, 0 to 1, of a colour that the page has computed.
function components(text) {
  return text.match(/[\d.]+/g).slice(0, 3).map(x => Number(x) / 255);
}

function fill_buffer(gl, buffer, numbers) {
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.DYNAMIC_DRAW);
}

function attributes_of(gl, sizes) {
  const stride = sizes.reduce((sum, size) => sum + size, 0);
  let from = 0;
  for (let k = 0; k < 3; ++k) {
    if (k >= sizes.length) {
      gl.disableVertexAttribArray(k);
      continue;
    }
    gl.enableVertexAttribArray(k);
    gl.vertexAttribPointer(k, sizes[k], gl.FLOAT, false, 4 * stride, 4 * from);
    from += sizes[k];
  }
}

function draw_surface(view, camera, ink) {
  const {gl, surface, triangles, corners} = view.graphics;
  gl.useProgram(surface.program);
  gl.uniformMatrix4fv(surface.at("seen"), false, camera.matrix);
  gl.uniformMatrix3fv(surface.at("turned"), false, camera.turned);
  gl.uniform1f(surface.at("stops"), view.colours.length);
  gl.uniform3fv(surface.at("rim"), ink);
  if (view.moved) fill_buffer(gl, corners, view.corners);
  gl.bindBuffer(gl.ARRAY_BUFFER, corners);
  attributes_of(gl, [3, 3, 1]);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, triangles.buffer);
  gl.enable(gl.POLYGON_OFFSET_FILL);
  gl.polygonOffset(1, 1);
  gl.drawElements(gl.TRIANGLES, triangles.count, triangles.type, 0);
  gl.disable(gl.POLYGON_OFFSET_FILL);
}

function use_plain(view, {matrix, colour, border = colour, size = 1, nearer = 0}) {
  const {gl, plain} = view.graphics;
  gl.useProgram(plain.program);
  gl.uniformMatrix4fv(plain.at("seen"), false, matrix);
  gl.uniform4fv(plain.at("colour"), colour);
  gl.uniform4fv(plain.at("border"), border);
  gl.uniform1f(plain.at("size"), size);
  gl.uniform1f(plain.at("round"), size > 1 ? 1 : 0);
  gl.uniform1f(plain.at("nearer"), nearer);
}

function draw_edges(view, camera) {
  const {gl, edges} = view.graphics;
  // Lines that are close together would hide the colours.
  const strength = Math.min(0.22, Math.max(0.02, 0.015 * (camera.scale * view.body.edge - 1)));
  use_plain(view, {matrix: camera.matrix, colour: [0.06, 0.06, 0.06, strength]});
  gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 28, 0);
  for (const k of [1, 2]) gl.disableVertexAttribArray(k);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, edges.buffer);
  gl.drawElements(gl.LINES, edges.count, edges.type, 0);
}

function draw_held(view, camera, ink, ground) {
  const {gl, others} = view.graphics, {held} = view.body;
  const places = new Float32Array(3 * held.length);
  held.forEach((point, i) => places.set(view.at.subarray(3 * point, 3 * point + 3), 3 * i));
  const size = (held.length > 400 ? 4.5 : 6.5) * view.dots;
  use_plain(view, {matrix: camera.matrix, colour: [...ink, 1], border: [...ground, 1], size, nearer: 0.01});
  fill_buffer(gl, others, places);
  attributes_of(gl, [3]);
  gl.drawArrays(gl.POINTS, 0, held.length);
}

// ---- The element of a mode, before everything else

const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
const owner_colour = [0.05, 0.78, 1], owner_border = [0, 0.13, 0.2];

/// A line of `width` pixels from `a` to `b` in clip coordinates, as two triangles.
function thick_line(a, b, width, canvas) {
  const half = [canvas.clientWidth / 2, canvas.clientHeight / 2];
  const along = [(b[0] - a[0]) * half[0], (b[1] - a[1]) * half[1]], size = Math.hypot(...along) || 1;
  const x = width / 2 * along[0] / size, y = width / 2 * along[1] / size;
  const corner =
      (p, forth, side) => [p[0] + (forth * x - side * y) / half[0], p[1] + (forth * y + side * x) / half[1], 0];
  const [p, q, r, s] = [corner(a, -1, -1), corner(a, -1, 1), corner(b, 1, -1), corner(b, 1, 1)];
  return [...p, ...q, ...r, ...r, ...q, ...s];
}

/// Pairs of points on a ring round `ends`, which are few pixels apart.
function ring_round(ends, canvas) {
  const sides = 32, radius = 14, middle = [0, 1].map(k => ends.reduce((sum, p) => sum + p[k], 0) / ends.length);
  const at = k =>
      [middle[0] + 2 * radius / canvas.clientWidth * Math.cos(2 * Math.PI * k / sides),
       middle[1] + 2 * radius / canvas.clientHeight * Math.sin(2 * Math.PI * k / sides)];
  return Array.from({length: sides}, (_, k) => [at(k), at(k + 1)]);
}

/// Pixels across what is between `ends`.
function size_on(canvas, ends) {
  const across = [canvas.clientWidth / 2, canvas.clientHeight / 2];
  return Math.hypot(
      ...across.map((half, k) => half * (Math.max(...ends.map(p => p[k])) - Math.min(...ends.map(p => p[k])))));
}

function draw_owner(view, camera) {
  const {canvas} = view, {gl, others} = view.graphics, {owner} = mode_of(view);
  const ends = owner.map(point => clip_of(camera.matrix, view.at, 3 * point)), size = size_on(canvas, ends);
  const pairs = ends.flatMap((a, i) => ends.slice(i + 1).map(b => [a, b]));
  const faces = ends.length === 3 ? [ends] :
      ends.length === 4           ? ends.map((_, i) => ends.filter((_, k) => k !== i)) :
                                    [];
  const width = Math.min(2.5, Math.max(1, size / 20)), rings = size < 24 ? ring_round(ends, canvas) : [];
  const draw = (numbers, colour) => {
    if (!numbers.length) return;
    use_plain(view, {matrix: identity, colour});
    fill_buffer(gl, others, Float32Array.from(numbers));
    attributes_of(gl, [3]);
    gl.drawArrays(gl.TRIANGLES, 0, numbers.length / 3);
  };
  const line = (ends, more, wide) => ends.flatMap(([a, b]) => thick_line(a, b, wide + more, canvas));
  gl.disable(gl.DEPTH_TEST);
  draw(faces.flat().flatMap(p => [...p, 0]), [...owner_colour, 0.12]);
  draw([...line(pairs, 2, width), ...line(rings, 2, 2)], [...owner_border, 1]);
  draw([...line(pairs, 0, width), ...line(rings, 0, 2)], [...owner_colour, 1]);
}
