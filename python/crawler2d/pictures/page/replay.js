// The page at work: time, controls and keys; redraws whenever something changes.

const data = JSON.parse(document.getElementById("recording").textContent);
const recording = new Recording(data);
const element = (id) => document.getElementById(id);
const scene = new Scene(element("scene"), data, recording);
const strip = new Strip(element("strip"), recording);
const { camera } = scene;
const embedded = window.self !== window.top;
const state = { time: recording.time[data.first], playing: false, drawn: 0, queued: false };
let colors = readColors();

// The colours of the style sheet, their names in camel case.
function readColors() {
  const style = getComputedStyle(document.documentElement);
  const names = [
    "ink", "quiet", "line", "ground", "ground-line", "grid", "track", "track-fill", "chassis",
    "chassis-fill", "halo", "force", "speed", "intrusion", "intrusion-fill", "stop", "stop-fill",
    "goal", "angle",
  ];
  const camel = (name) => name.replace(/-(.)/g, (_, letter) => letter.toUpperCase());
  const value = (name) => style.getPropertyValue(`--${name}`).trim();
  return Object.fromEntries(names.map((name) => [camel(name), value(name)]));
}

function changed() {
  if (state.queued) return;
  state.queued = true;
  requestAnimationFrame(draw);
}

function draw(now) {
  state.queued = false;
  if (state.playing) {
    const passed = Math.max(0, now - state.drawn) / 1000;
    state.drawn = now;
    state.time = Math.min(recording.end, state.time + passed * Number(element("speed").value));
    if (state.time >= recording.end) play(false);
    else changed();
  }
  scene.draw(state.time, colors);
  strip.draw(state.time, colors);
  tell();
}

function tell() {
  const moment = recording.at(state.time);
  const seconds = state.time.toFixed(2);
  const shown = (value, digits) => value.toFixed(digits).replace(/^-(?=[0.]*$)/, "").replace("-", "−");
  const degrees = (moment.angle * 180) / Math.PI;
  element("scrub").value = String(recording.nearestFrame(state.time));
  element("scrub").setAttribute("aria-valuetext", `${seconds} seconds`);
  element("clock").textContent = `${seconds} / ${recording.end.toFixed(2)} s`;
  element("readout").textContent =
    `x ${shown(moment.x, 3)} m · y ${shown(moment.y, 3)} m · ${shown(degrees, 1)}° · ` +
    `track ${shown(moment.speed, 2)} m/s`;
}

function play(on) {
  state.playing = on;
  if (on) {
    if (state.time >= recording.end) state.time = recording.begin;
    state.drawn = performance.now();
  } else state.time = recording.time[recording.nearestFrame(state.time)]; // snap to a recorded sample
  element("play").setAttribute("aria-label", on ? "pause" : "play");
  element("play-shape").setAttribute("d", on ? "M3 2.5h3.6v11H3zM9.4 2.5H13v11H9.4z" : "M4 2.5v11l9-5.5z");
  changed();
}

// Goes to a frame and pauses there.
function seek(frame) {
  state.time = recording.time[Math.max(0, Math.min(recording.count - 1, frame))];
  if (state.playing) play(false);
  changed();
}

function follow(on) {
  element("follow").checked = on;
  camera.follow(on, recording.at(state.time));
  changed();
}

function reset() {
  camera.reset();
  changed();
}

function fit() {
  const ratio = window.devicePixelRatio || 1;
  for (const part of [camera, strip]) {
    const canvas = part === camera ? scene.canvas : strip.canvas;
    const { clientWidth, clientHeight } = canvas;
    canvas.width = Math.max(1, Math.round(clientWidth * ratio));
    canvas.height = Math.max(1, Math.round(clientHeight * ratio));
    part.resize(Math.max(1, clientWidth), Math.max(1, clientHeight));
  }
  changed();
}

// Shows where the robot ended in a trial, beside where it stopped; a second press hides it.
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
  const frame = recording.nearestFrame(state.time);
  const step = event.shiftKey ? 10 : 1;
  const actions = {
    " ": () => event.repeat || play(!state.playing),
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
  element("scrub").max = String(recording.count - 1);
  element("follow").checked = camera.follows;
  element("play").addEventListener("click", () => play(!state.playing));
  element("scrub").addEventListener("input", (event) => seek(Number(event.target.value)));
  element("follow").addEventListener("change", (event) => follow(event.target.checked));
  element("reset").addEventListener("click", reset);
  document.addEventListener("keydown", press);
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
  new ResizeObserver(fit).observe(scene.canvas);
  fit();
}

main();
