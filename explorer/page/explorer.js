// The page at work: simulates changes, and draws the robot and the belt next to each other at the same time.

const tables = JSON.parse(element("tables").textContent);
const state = new State(tables, FIELDS);
const player = new Player(draw);
const changed = () => player.changed();
let colors = readColors();
let resting; // timer for the work that is done when nothing has changed for a while

// [s] Between two pictures; they are interpolated.
const INTERVAL = 0.02;
// [ms] Time from the last change to the trials of stops.
const REST = 250;

const requested = (scenario, trials, interval) =>
  `{"scenario":${scenario},"trials":${JSON.stringify(trials)},"sample_interval":${interval}}`;

// One of the two robots: its core, its picture, its caption, and its last answer.
class View {
  constructor(figure, sentence, core, subject) {
    Object.assign(this, { figure, sentence, core, subject, answer: null, scene: null });
    this.canvas = figure.querySelector("canvas");
    // Will be set to the stretch that both robots visit.
    this.camera = new Camera([0, 1, 0, 1], 1);
    watchPointer(this.canvas, this.camera, changed, true);
    this.canvas.addEventListener("keydown", ({ key }) => {
      if (key === "+" || key === "-") this.camera.zoom(key === "+" ? 1.25 : 0.8);
      else if (key === "0") this.camera.reset();
      changed();
    });
  }

  // Simulates it without trials, and returns whether there is something to show. The end of a drag often repeats its
  // last step, and waits for the same run.
  simulate(scenario) {
    const text = JSON.stringify(scenario);
    if (text !== this.text) this.running = this.run(text);
    return this.running;
  }

  async run(text) {
    this.text = text;
    const answer = await this.core.ask(requested(text, null, INTERVAL));
    if (!answer) return false;
    Object.assign(this, { answer, answered: text });
    if (answer.drawing) {
      const { drawing } = answer;
      this.scene = new Scene(this.canvas, drawing, new Recording(drawing));
      Object.assign(this.scene, { drawing, camera: this.camera });
    }
    this.tell();
    return true;
  }

  // Makes the trials at the stop that its outcome needs, and a few more.
  async judge() {
    const { text } = this;
    // A run in progress is not replaced; it is judged when it has finished.
    if (text !== this.answered || this.answer.error || this.answer.judged) return;
    const judged = await this.core.ask(requested(text, tables.trials, null), "trials");
    if (!judged || text !== this.text) return;
    this.answer = { ...judged, drawing: this.answer.drawing };
    this.tell();
  }

  get ending() {
    const { error, judged, outcome, metrics, diagnosis } = this.answer;
    if (error) return "not simulated";
    const end = judged ? spaced(outcome) : "stopped";
    // A run continues for a while after a stop has begun, or the goal is reached.
    if (diagnosis && !diagnosis.transient) return `${end} at ${diagnosis.since.toFixed(1)} s`;
    const time = judged && outcome === "cleared" ? metrics.time_to_clear : metrics.time;
    return `${end} after ${time.toFixed(1)} s`;
  }

  // The outcome above the picture, and the sentence below.
  tell() {
    const { error, judged, outcome, diagnosis, warnings } = this.answer;
    const part = (name) => this.figure.querySelector(`.${name}`);
    const subject = this.subject();
    part("subject").textContent = subject;
    part("ending").textContent = this.ending;
    part("ending").dataset.outcome = error ? "error" : judged ? outcome : "";
    part("mechanism").textContent = diagnosis?.mechanism ?? "";
    part("mechanism").title = tables.words.mechanisms[diagnosis?.mechanism] ?? "";
    const sentence = diagnosis ? new Sentence(diagnosis, tables.words).text() : tables.words.outcomes[outcome];
    const warned = (warnings ?? []).map(({ path, reason }) => ` ${path} ${reason}.`).join("");
    this.sentence.className = error ? "error" : "";
    this.sentence.textContent = error ? error.message : `${sentence}.${warned}`;
    this.figure.classList.toggle("stale", Boolean(error));
    this.canvas.setAttribute("aria-label", `${subject}, side view: ${this.ending}`);
  }
}

// The description of the track, as in the package.
function trackInWords() {
  const { kind } = state.scenario.robot.track;
  return tables.words.tracks[kind].replace(/\{(.*?)\}/g, (_, path) => state.get(`robot.track.${path}`));
}

let controls;
let handles;
let views = [];

// Simulates the state; `isLast` ends a drag, after which the picture may move.
async function update(isLast = true) {
  clearTimeout(resting);
  controls.show();
  const scenarios = [state.scenario, state.belt()];
  await Promise.all(views.map(async (view, i) => {
    if (await view.simulate(scenarios[i])) show();
  }));
  if (isLast) look();
  clearTimeout(resting);
  resting = setTimeout(rest, REST);
}

// Nothing has changed for a while: updates the address, and makes the trials of stops.
function rest() {
  history.replaceState(null, "", link());
  return judge();
}

const link = () => `${location.href.split("#")[0]}${state.hash && "#"}${state.hash}`;

async function judge() {
  await Promise.all(views.map((view) => view.judge()));
  element("status").textContent = views
    .map(({ figure, answer }) => answer && `${figure.querySelector(".subject").textContent}: `
      + `${figure.querySelector(".ending").textContent}`)
    .filter(Boolean).join("; ");
}

const shown = () => views.map(({ scene }) => scene).filter(Boolean);

// [m] Position at which the robot is well past the goal, which its rear end has to reach.
const past = ({ drawing: { robot, ground } }) => ground.goal + 0.7 * robot.length;

// Shows the new runs; a robot that was shown at its end is shown at its new end.
function show() {
  const scenes = shown();
  if (!scenes.length) return;
  const atEnd = player.time >= player.end;
  const [{ forceScale, speedScale }] = scenes;
  for (const scene of scenes) {
    const { recording } = scene;
    const last = recording.x.findIndex((x) => x > past(scene));
    const end = last > 0 ? recording.time[last] : recording.end;
    Object.assign(scene, { end, forceScale, speedScale });
  }
  player.end = Math.max(...scenes.map(({ end }) => end));
  player.time = atEnd ? player.end : Math.min(player.time, player.end);
  element("scrub").max = String(player.end);
  changed();
}

// Both pictures show the stretch that the robots visit until they are past the goal.
function look() {
  const scenes = shown();
  if (!scenes.length) return;
  const extents = scenes.map(({ drawing }) => drawing.extent);
  const side = (i) => Math[i % 2 ? "max" : "min"](...extents.map((extent) => extent[i]));
  const { length } = scenes[0].drawing.robot;
  const right = Math.min(side(1), past(scenes[0]) + 0.6 * length);
  const bottom = side(2) - 0.3 * length; // room for the text in the ground
  for (const { camera } of scenes) {
    Object.assign(camera, { left: side(0), right, bottom, top: side(3), robotLength: length });
    if (!camera.touched) camera.reset();
  }
  changed();
}

// After its end, a run is shown as it ended.
function draw(time) {
  const { playing } = player;
  for (const { scene } of views) scene?.draw(Math.min(time, scene.end), colors);
  const [{ scene }] = views;
  if (scene) handles.show(scene, Math.min(time, scene.end), playing);
  element("scrub").value = String(time);
  element("scrub").setAttribute("aria-valuetext", `${time.toFixed(2)} seconds`);
  element("clock").textContent = `${time.toFixed(2)} / ${player.end.toFixed(2)} s`;
}

function resize() {
  for (const { canvas, camera } of views) fit(canvas, camera);
  changed();
}

function press(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches("button, select, input, textarea, summary")) return;
  const step = (event.shiftKey ? 10 : 1) * INTERVAL;
  const actions = {
    " ": () => event.repeat || player.play(!player.playing),
    ArrowLeft: () => player.seek(Math.max(0, player.time - step)),
    ArrowRight: () => player.seek(Math.min(player.end, player.time + step)),
    Home: () => player.seek(0),
    End: () => player.seek(player.end),
  };
  const action = Object.hasOwn(actions, event.key) && actions[event.key];
  if (!action) return;
  event.preventDefault();
  action();
}

// Shows a text to copy, and copies it if the browser allows that.
async function copy(name, text) {
  const place = element("copied");
  place.hidden = false;
  place.value = text;
  place.setAttribute("aria-label", name);
  place.select();
  try {
    await navigator.clipboard.writeText(text);
    element("status").textContent = element("told").textContent = `${name} copied`;
  } catch {
    element("told").textContent = `${name}: select and copy`;
  }
}

async function main() {
  const module = await compiled(element("core").textContent);
  const source = element("worker").textContent;
  const [figures, sentences] = [".pair figure", ".sentences p"].map((each) => document.querySelectorAll(each));
  views = [trackInWords, () => tables.words.tracks.belt].map((subject, i) =>
    new View(figures[i], sentences[i], new Core(module, source), subject));
  controls = new Controls(element("fields"), state, update);
  handles = new Handles(element("handles"), state, update);
  state.hash = location.hash.slice(1);
  addEventListener("hashchange", () => {
    state.hash = location.hash.slice(1);
    update();
  });
  element("scrub").addEventListener("input", (event) => player.seek(Number(event.target.value)));
  element("start").addEventListener("click", () => {
    state.reset();
    update();
  });
  element("copy-link").addEventListener("click", () => copy("link", link()));
  element("copy-json").addEventListener("click", () => copy("scenario as JSON", state.json()));
  element("copy-python").addEventListener("click", () => copy("scenario as Python", state.python()));
  document.addEventListener("keydown", press);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    colors = readColors();
    changed();
  });
  for (const { canvas } of views) new ResizeObserver(resize).observe(canvas);
  resize();
  await update();
  element("loading").remove();
  document.documentElement.dataset.ready = String(Math.round(performance.now()));
}

main().catch((error) => {
  element("loading").textContent = `The simulator does not run here: ${error.message}`;
});
