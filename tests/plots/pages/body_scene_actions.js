// Drives a page with a body in a browser: body_scene_browser_test.cpp appends this script to the page. It writes one
// line for each thing that it finds, "name: value", into an element of its own.
"use strict";
(async () => {
  const lines = [];
  const find = (name, value) => lines.push(name + ": " + value);
  const one = selector => document.querySelector(selector);
  const all = selector => [...document.querySelectorAll(selector)];
  const frame = () => new Promise(done => requestAnimationFrame(done));
  const wait = ms => new Promise(done => setTimeout(done, ms));
  const canvas = one(".scene canvas"), [show, colour, factor] = all(".scene-tools select");
  const button = name => all(".scene button").find(each => each.textContent === name);
  const time = () => one(".scene-time").textContent;
  const choose = (select, value) => {
    select.value = value;
    select.dispatchEvent(new Event("change"));
  };
  const press = (key, shiftKey = false) =>
      canvas.dispatchEvent(new KeyboardEvent("keydown", {key, shiftKey, bubbles: true, cancelable: true}));
  /// The pixels; body_scene_browser_test.cpp lets the canvas keep them.
  const picture = () => {
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [canvas.width, canvas.height];
    copy.getContext("2d").drawImage(canvas, 0, 0);
    return copy.getContext("2d").getImageData(0, 0, copy.width, copy.height).data;
  };
  /// The share of the pixels that are not empty.
  const painted = pixels => {
    let count = 0;
    for (let i = 3; i < pixels.length; i += 4) count += pixels[i] > 0;
    return count / (pixels.length / 4);
  };
  const differ = (p, q) => p.length !== q.length || p.some((x, i) => x !== q[i]);
  const after = async action => {
    await action();
    await frame();
    return picture();
  };
  const dispatch_pointers = () => {
    const at = (name, x, y) =>
        canvas.dispatchEvent(new PointerEvent(name, {clientX: x, clientY: y, pointerId: 1, bubbles: true}));
    at("pointerdown", 200, 200);
    at("pointermove", 260, 220);
    at("pointerup", 260, 220);
  };

  async function drive_view() {
    press("Home");
    const first = await after(() => press("Home"));
    find("painted", painted(first) > 0.1 && painted(first) < 0.9);
    find("arrow turns", differ(first, await after(() => press("ArrowRight"))));
    find("Home returns", !differ(first, await after(() => press("Home"))));
    find("plus zooms", painted(await after(() => press("+"))) > painted(first));
    find("button zooms", painted(await after(() => button("\u2212").click())) <= painted(first) * 1.01);
    find("Shift shifts", differ(first, await after(() => press("ArrowUp", true))));
    find("Reset returns", !differ(first, await after(() => button("Reset").click())));
    find("drag turns", differ(first, await after(dispatch_pointers)));
    await after(() => press("Home"));
    find(
        "wheel alone", !differ(first, await after(() => canvas.dispatchEvent(new WheelEvent("wheel", {deltaY: -99})))));
    const wheel = new WheelEvent("wheel", {deltaY: -99, ctrlKey: true, cancelable: true});
    find("wheel with Ctrl", differ(first, await after(() => canvas.dispatchEvent(wheel))) && wheel.defaultPrevented);
    await after(() => press("Home"));
    const mesh = one(".scene-tools input");
    find("mesh", differ(first, await after(() => mesh.click())) && !differ(first, await after(() => mesh.click())));
    find("theme", differ(first, await after(() => document.documentElement.dataset.theme = "dark")));
    await after(() => delete document.documentElement.dataset.theme);
  }

  async function drive_motion() {
    const slider = one(".scene-play input"), first = await after(() => press("Home"));
    find("time at first", time());
    slider.value = 0;
    const start = await after(() => slider.dispatchEvent(new Event("input")));
    find("time at start", time() + (differ(first, start) ? "" : " with the same picture"));
    find("words for the slider", slider.getAttribute("aria-valuetext") === time());
    slider.value = 8;
    const later = await after(() => slider.dispatchEvent(new Event("input")));
    find("deformation", differ(later, await after(() => choose(factor, "5"))));
    await after(() => choose(factor, "1"));
    find(
        "colour",
        differ(later, await after(() => choose(colour, "energy"))) + " " + one(".scene-bar span").textContent);
    await after(() => choose(colour, "displacement"));
    find("colours", one(".scene-bar span").textContent);
    slider.value = slider.max;
    await after(() => slider.dispatchEvent(new Event("input")));
    const end = time();
    button("Play").click();
    await wait(600);
    await frame();
    find("plays", (time() !== end) + " " + (button("Pause") !== undefined));
    await after(() => button("Pause").click());
    const still = time();
    await wait(300);
    find("pauses", time() === still);
  }

  async function drive_modes() {
    choose(show, "1");
    find("mode plays", button("Pause") !== undefined);
    const before = picture();
    await wait(250);
    find("mode moves", differ(before, picture()));
    find("words", one(".scene-words").textContent);
    find("without time", one(".scene-time").offsetParent === null && factor.offsetParent === null);
    await after(() => press(" "));
    find("Space pauses", button("Play") !== undefined);
    // The element of this mode has a colour of its own.
    const pixels = await after(() => press("+"));
    const owner = pixels.some((x, i) => i % 4 === 0 && x < 40 && pixels[i + 1] > 180 && pixels[i + 2] > 220);
    find("element", owner);
    choose(show, "motion");
    await frame();
    find("motion waits", button("Play") !== undefined && time() !== "");
  }

  function check_page() {
    find("markup", all(".evil").length);
    find(
        "without names",
        all(".scene button, .scene input, .scene select, .scene canvas")
            .filter(each => !(each.textContent.trim() || each.closest("label") || each.getAttribute("aria-label")))
            .length);
    find("reached by keyboard", all(".scene canvas, .scene button").every(each => each.tabIndex === 0));
    document.body.style.width = "360px";
    document.body.style.margin = "0";
    const wide =
        all("body *").filter(each => !each.closest("script, style") && each.getBoundingClientRect().right > 361);
    find("wider than a phone", wide.length === 0 ? "nothing" : wide[0].outerHTML.slice(0, 80).replace(/[<>&]/g, " "));
  }

  async function lose_context() {
    const lost = canvas.getContext("webgl").getExtension("WEBGL_lose_context");
    lost.loseContext();
    await wait(50);
    find("picture when lost", one(".scene-picture img").offsetParent !== null && canvas.offsetParent === null);
    lost.restoreContext();
    await wait(50);
    const pixels = await after(() => press("Home"));
    find("back again", canvas.offsetParent !== null && painted(pixels) > 0.1);
  }

  try {
    await wait(300);
    const live = one(".scene").classList.contains("scene-live");
    find("WebGL", live);
    find("picture", one(".scene-picture img").offsetParent !== null);
    find("picture has pixels", one(".scene-picture img").naturalWidth > 0);
    find("note", one(".scene-note").textContent);
    if (live) {
      await drive_view();
      await drive_motion();
      await drive_modes();
      await lose_context();
    }
    check_page();
  } catch (error) {
    find("script", error);
  }
  find("errors", window.page_errors.length === 0 ? "none" : window.page_errors.join(" "));
  const told = document.createElement("pre");
  told.id = "findings";
  told.textContent = "\n" + lines.join("\n") + "\n";
  document.body.append(told);
})();
