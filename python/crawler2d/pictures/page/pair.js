// Runs side by side, at the same time, place and scale.

const player = new Player(draw);
let scenes = [];
let colors = readColors();

// After its end, a run is shown as it ended.
function draw(time) {
  for (const scene of scenes) scene.draw(Math.min(time, scene.end), colors);
  element("scrub").value = String(time);
  element("scrub").setAttribute("aria-valuetext", `${time.toFixed(1)} seconds`);
  element("clock").textContent = `${time.toFixed(1)} / ${player.end.toFixed(1)} s`;
}

// Both pictures show the same place, in which the second robot gets past the goal; arrows have the
// same scale.
function scenesOf(runs, canvases) {
  const [{ robot: { length }, ground: { goal } }] = runs;
  const past = goal === null ? Infinity : goal + length;
  const extent = [0, 1, 2, 3].map((side) =>
    Math[side % 2 ? "max" : "min"](...runs.map((run) => run.extent[side])));
  extent[1] = Math.min(extent[1], Math.max(runs[0].extent[1], past + length / 2));
  const both = runs.map((run, k) =>
    new Scene(canvases[k], { ...run, extent, robot: { ...run.robot, length } }, new Recording(run)));
  const { forceScale, speedScale } = both[0];
  for (const scene of both) {
    const { canvas, camera, recording } = scene;
    const last = recording.x.findIndex((x) => x > past);
    const end = last > 0 ? recording.time[last] : recording.end;
    Object.assign(scene, { end, forceScale, speedScale });
    const changed = () => player.changed();
    watchPointer(canvas, camera, changed, true);
    canvas.addEventListener("keydown", ({ key }) => {
      if (key === "+" || key === "-") camera.zoom(key === "+" ? 1.25 : 0.8);
      else if (key === "0") camera.reset();
      changed();
    });
  }
  return both;
}

function resize() {
  for (const { canvas, camera } of scenes) fit(canvas, camera);
  player.changed();
}

// They play, or show the end for users who prefer no motion.
function show(both) {
  scenes = both;
  player.time = player.end = Math.max(...scenes.map(({ end }) => end));
  element("scrub").max = String(player.end);
  // Slow robots are also shown in a quarter of a minute.
  const speeds = [...element("speed").options].map(({ value }) => Number(value));
  element("speed").value = String(speeds.find((speed) => speed >= 1 && player.end / speed < 15) ?? 10);
  player.play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
  resize();
}

function listen() {
  element("scrub").addEventListener("input", (event) => player.seek(Number(event.target.value)));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    colors = readColors();
    player.changed();
  });
  new ResizeObserver(resize).observe(element("stage"));
}
