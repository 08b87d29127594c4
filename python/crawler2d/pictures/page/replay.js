// The page at work: time, controls and keys; redraws whenever something changes.

const data = JSON.parse(document.getElementById("recording").textContent);
const recording = new Recording(data);
const scene = new Scene(element("scene"), data, recording);
const strip = new Strip(element("strip"), recording);
const { camera } = scene;
const embedded = window.self !== window.top;
const player = new Player(draw, (time) => recording.time[recording.nearestFrame(time)]);
const changed = () => player.changed();
let colors = readColors();

function draw(time) {
  scene.draw(time, colors);
  strip.draw(time, colors);
  tell(time);
}

function tell(time) {
  const moment = recording.at(time);
  const seconds = time.toFixed(2);
  const shown = (value, digits) => value.toFixed(digits).replace(/^-(?=[0.]*$)/, "").replace("-", "−");
  const degrees = (moment.angle * 180) / Math.PI;
  element("scrub").value = String(recording.nearestFrame(time));
  element("scrub").setAttribute("aria-valuetext", `${seconds} seconds`);
  element("clock").textContent = `${seconds} / ${recording.end.toFixed(2)} s`;
  element("readout").textContent =
    `x ${shown(moment.x, 3)} m · y ${shown(moment.y, 3)} m · ${shown(degrees, 1)}° · ` +
    `track ${shown(moment.speed, 2)} m/s`;
  // For a widget, which is the only listener.
  if (embedded) window.parent.postMessage({ crawler2d: time }, "*");
}

// Goes to a frame and pauses there.
function seek(frame) {
  player.seek(recording.time[Math.max(0, Math.min(recording.count - 1, frame))]);
}

function follow(on) {
  element("follow").checked = on;
  camera.follow(on, recording.at(player.time));
  changed();
}

function reset() {
  camera.reset();
  changed();
}

// Shows the end of a trial together with the stop; a second press hides it.
function showTrial(number) {
  scene.ghost = scene.ghost === number ? null : number;
  for (const button of document.querySelectorAll("[data-trial]")) {
    button.setAttribute("aria-pressed", String(Number(button.dataset.trial) === scene.ghost));
  }
  if (scene.ghost !== null) {
    seek(recording.count - 1);
    const stop = recording.at(recording.end);
    camera.look(stop);
    camera.include([stop.x, stop.y], scene.ghosts[scene.ghost].frames[0]);
    element("follow").checked = camera.follows;
  }
  changed();
}

// Draws an arrow of a round number in the legend, at the scale of the picture.
function showScale(name, scale, unit) {
  const value = nice(75 / scale);
  element(`${name}-rule`).style.width = `${value * scale}px`;
  element(`${name}-scale`).textContent = `${+value.toPrecision(3)} ${unit}`;
}

function press(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const on = event.target;
  const slides = on === element("scrub");
  if (!slides && on.matches?.("button, select, summary, input") && !"fF0+-".includes(event.key)) return;
  const frame = recording.nearestFrame(player.time);
  const step = event.shiftKey ? 10 : 1;
  const actions = {
    " ": () => event.repeat || player.play(!player.playing),
    ArrowLeft: () => seek(frame - step),
    ArrowRight: () => seek(frame + step),
    Home: () => seek(0),
    End: () => seek(recording.count - 1),
    "+": () => camera.zoom(1.25),
    "=": () => camera.zoom(1.25),
    "-": () => camera.zoom(0.8),
    f: () => follow(!camera.follows),
    F: () => follow(!camera.follows),
    0: reset,
  };
  const action = Object.hasOwn(actions, event.key) && actions[event.key];
  if (!action) return;
  event.preventDefault();
  action();
  changed();
}

function main() {
  Object.assign(player, { time: recording.time[data.first], begin: recording.begin, end: recording.end });
  element("scrub").max = String(recording.count - 1);
  element("follow").checked = camera.follows;
  element("scrub").addEventListener("input", (event) => seek(Number(event.target.value)));
  element("follow").addEventListener("change", (event) => follow(event.target.checked));
  element("reset").addEventListener("click", reset);
  document.addEventListener("keydown", press);
  window.addEventListener("message", ({ source, data: told }) => {
    if (source === window.parent && Number.isFinite(told?.crawler2d)) seek(recording.nearestFrame(told.crawler2d));
  });
  watchPointer(scene.canvas, camera, changed, embedded);
  const scrubStrip = (event) => {
    if (event.buttons & 1) seek(recording.nearestFrame(strip.time(event.offsetX)));
  };
  strip.canvas.addEventListener("pointerdown", scrubStrip);
  strip.canvas.addEventListener("pointermove", scrubStrip);
  for (const box of document.querySelectorAll("[data-layer]")) {
    box.addEventListener("change", () => {
      scene.layers[box.dataset.layer] = box.checked;
      changed();
    });
  }
  for (const button of document.querySelectorAll("[data-trial]")) {
    button.addEventListener("click", () => showTrial(Number(button.dataset.trial)));
  }
  for (const item of document.querySelectorAll("[data-needs]")) {
    item.hidden = !scene.has(item.dataset.needs);
  }
  const hint = () => {
    element("hint").hidden = !embedded || document.activeElement === scene.canvas;
  };
  scene.canvas.addEventListener("focus", hint);
  scene.canvas.addEventListener("blur", hint);
  hint();
  showScale("force", scene.forceScale, "N");
  showScale("speed", scene.speedScale, "m/s");
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    colors = readColors();
    changed();
  });
  const resize = () => {
    fit(scene.canvas, camera);
    fit(strip.canvas, strip);
    changed();
  };
  new ResizeObserver(resize).observe(scene.canvas);
  resize();
}

main();
