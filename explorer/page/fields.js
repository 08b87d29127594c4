// Fields that can be changed: path in the scenario, range in SI units, label and unit.

const FIELDS = [
  {
    group: "track", path: "robot.track.kind", label: "model",
    choices: [
      ["line", "wheels in a line"], ["circumferential", "wheels all round"],
      ["grouser_belt", "belt with grousers"], ["segmental", "chain of shoes"],
    ],
  },
  {
    group: "track", path: "robot.track.wheel.kind", label: "wheel shape",
    choices: [["round", "round"], ["gear", "with grousers"]],
  },
  { group: "track", path: "robot.track.count", label: "number of wheels", range: [2, 40, 1], unit: "" },
  { group: "track", path: "robot.track.wheel_radius", label: "wheel radius", range: [0.01, 0.09, 0.0002], unit: "mm" },
  { group: "track", path: "robot.outline.axle_distance", label: "axle distance", range: [0.2, 0.6, 0.005], unit: "mm" },
  { group: "track", path: "robot.outline.grouser_height", label: "grouser height", range: [0.002, 0.03, 0.001], unit: "mm" },
  {
    group: "ground", path: "terrain.kind", label: "obstacle",
    choices: [
      ["step", "step"], ["barrier", "barrier"], ["ridge", "ridge"], ["half_round", "half round"],
      ["gap", "gap"], ["stairs", "stairs"],
    ],
  },
  { group: "ground", path: "terrain.height", label: "height", range: [0.005, 0.2, 0.001], unit: "mm" },
  { group: "ground", path: "terrain.radius", label: "radius", range: [0.005, 0.2, 0.001], unit: "mm" },
  { group: "ground", path: "terrain.width", label: "width", range: [0.01, 0.4, 0.002], unit: "mm" },
  { group: "ground", path: "terrain.rise", label: "rise", range: [0.01, 0.2, 0.001], unit: "mm" },
  { group: "ground", path: "terrain.thickness", label: "thickness", range: [0.01, 0.4, 0.002], unit: "mm" },
  { group: "ground", path: "terrain.edge_radius", label: "edge radius", range: [0, 0.03, 0.0005], unit: "mm" },
  { group: "ground", path: "terrain.friction", label: "friction", range: [0.1, 1.5, 0.02], unit: "" },
  { group: "robot", path: "robot.center_of_mass[0]", label: "centre of mass, x", range: [-0.15, 0.15, 0.002], unit: "mm" },
  { group: "robot", path: "robot.center_of_mass[1]", label: "centre of mass, y", range: [-0.05, 0.15, 0.002], unit: "mm" },
  { group: "robot", path: "robot.drivetrain.max_torque", label: "sprocket torque", range: [0.5, 20, 0.1], unit: "N m" },
  { group: "robot", path: "drive.speed", label: "speed", range: [0.05, 1.2, 0.05], unit: "m/s" },
];

const GROUPS = { track: "Track", ground: "Ground", robot: "Robot and drive" };

// A value as text, in millimetres if it is a length.
function inWords({ unit }, value) {
  const number = unit === "mm" ? 1e3 * value : value;
  return `${Number(number.toPrecision(4))}${unit && " "}${unit}`.replace("-", "−");
}

// Whether a field has an effect in a scenario: those of grousers only if there are any.
function applies({ path }, state) {
  if (path !== "robot.outline.grouser_height") return state.has(path);
  const { kind, wheel } = state.scenario.robot.track;
  return ["grouser_belt", "segmental"].includes(kind) || wheel?.kind === "gear";
}

// The distance between the wheels of a line; an empty text for other tracks.
function spacing({ robot: { track, outline } }) {
  if (track.kind !== "line") return "";
  const apart = outline.axle_distance / (track.count - 1);
  const gap = apart - 2 * track.wheel_radius;
  const millimetres = `${(1e3 * Math.abs(gap)).toFixed(1)} mm`;
  const how = Math.abs(gap) < 5e-4 ? "they touch" : gap > 0 ? `gaps of ${millimetres}` : `they overlap by ${millimetres}`;
  return `wheels ${(1e3 * apart).toFixed(1)} mm apart: ${how}`;
}

// Sliders and lists; `changed` is called for each change, with whether it is the last of a drag.
class Controls {
  constructor(place, state, changed) {
    this.state = state;
    this.rows = FIELDS.map((field) => ({ field, ...(field.choices ? list(field) : slider(field)) }));
    for (const [group, title] of Object.entries(GROUPS)) {
      const set = document.createElement("fieldset");
      const legend = document.createElement("legend");
      legend.textContent = title;
      set.append(legend, ...this.rows.filter(({ field }) => field.group === group).map(({ row }) => row));
      place.append(set);
      if (group !== "track") continue;
      this.note = document.createElement("p");
      this.note.className = "note";
      set.append(this.note);
    }
    for (const { field, input } of this.rows) {
      const take = (isLast) => {
        state.set(field.path, field.choices ? input.value : Number(input.value));
        changed(isLast);
      };
      input.addEventListener("input", () => take(false));
      input.addEventListener("change", () => take(true));
    }
  }

  // Shows the state.
  show() {
    this.note.textContent = spacing(this.state.scenario);
    for (const { field, row, input, output } of this.rows) {
      row.hidden = !applies(field, this.state);
      if (row.hidden) continue;
      const value = this.state.get(field.path);
      input.value = String(value);
      if (!output) continue;
      const text = inWords(field, value);
      output.textContent = text;
      input.setAttribute("aria-valuetext", text);
    }
  }
}

function labelled(field, input) {
  const row = document.createElement("div");
  const label = document.createElement("label");
  input.id = `field-${field.path}`;
  label.htmlFor = input.id;
  label.textContent = field.label;
  row.className = "field";
  row.append(label, input);
  return row;
}

function slider(field) {
  const input = document.createElement("input");
  const output = document.createElement("output");
  const [min, max, step] = field.range;
  Object.assign(input, { type: "range", min, max, step });
  const row = labelled(field, input);
  output.htmlFor = input.id;
  row.append(output);
  return { row, input, output };
}

function list(field) {
  const input = document.createElement("select");
  for (const [value, text] of field.choices) input.append(new Option(text, value));
  return { row: labelled(field, input), input };
}
