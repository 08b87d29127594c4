// The scenario as JSON; a link contains its differences from the initial scenario.

class State {
  // `tables` has the initial scenario, and one track and one ground of each kind.
  constructor(tables, fields) {
    this.tables = tables;
    this.fields = fields;
    this.reset();
  }

  reset() {
    this.scenario = structuredClone(this.tables.begin);
  }

  get(path) {
    return valueAt(this.scenario, path);
  }

  has(path) {
    return typeof this.get(path) === "number" || typeof this.get(path) === "string";
  }

  set(path, value) {
    const keys = keysOf(path);
    const last = keys.pop();
    const place = keys.reduce((object, key) => object[key], this.scenario);
    if (last !== "kind") place[last] = value;
    else if (place.kind !== value) this.choose(keys, this.tables.kinds[keys.join(".")][value]);
    // The belly is as long as the axle distance.
    if (last === "axle_distance") {
      for (const corner of this.scenario.robot.belly) corner[0] = (Math.sign(corner[0]) * value) / 2;
    }
  }

  // Replaces a track, wheel or ground; common values of shape and friction stay.
  choose(keys, chosen) {
    const last = keys[keys.length - 1];
    const parent = keys.slice(0, -1).reduce((object, key) => object[key], this.scenario);
    const { wheel, friction, edge_radius: edgeRadius } = parent[last];
    parent[last] = structuredClone(chosen);
    const kept = { wheel, friction, edge_radius: edgeRadius };
    for (const [name, value] of Object.entries(kept)) {
      if (value !== undefined && name in parent[last]) parent[last][name] = value;
    }
  }

  // The same robot with a belt along its outline.
  belt() {
    const scenario = structuredClone(this.scenario);
    scenario.robot.track = this.tables.belt;
    return scenario;
  }

  get hash() {
    const plain = new State(this.tables, this.fields);
    const found = new URLSearchParams();
    for (const { path } of this.fields) {
      if (!this.has(path) || plain.get(path) === this.get(path)) continue;
      found.set(path, String(this.get(path)));
      // From here on, differences are relative to the default of this kind.
      if (path.endsWith(".kind")) plain.set(path, this.get(path));
    }
    return String(found);
  }

  // Values that no field accepts are left out: a link may be from another version.
  set hash(text) {
    this.reset();
    const given = new URLSearchParams(text);
    for (const { path, choices } of this.fields) {
      const value = given.get(path);
      if (value === null || !this.has(path)) continue;
      if (!choices && value.trim() !== "" && Number.isFinite(Number(value))) this.set(path, Number(value));
      else if (choices?.some(([name]) => name === value)) this.set(path, value);
    }
  }

  json() {
    return JSON.stringify(this.scenario, null, 1);
  }

  // The lines of Python that make this scenario.
  python() {
    const { begin, code, classes } = this.tables;
    const changed = [];
    const written = (value) => {
      if (value === null) return "None";
      if (typeof value === "boolean") return value ? "True" : "False";
      if (typeof value !== "object") return JSON.stringify(value);
      const { kind, ...rest } = value;
      const fields = Object.entries(rest).map(([name, each]) => `${name}=${written(each)}`);
      return `c2d.${classes[kind]}(${fields.join(", ")})`;
    };
    const compare = (path, before, now) => {
      if (now?.kind !== undefined && JSON.stringify(before) !== JSON.stringify(now)) {
        changed.push(`    "${path}": ${written(now)},\n`);
      } else if (now && typeof now === "object") {
        const name = (key) => (Array.isArray(now) ? `${path}[${key}]` : path ? `${path}.${key}` : key);
        for (const key of Object.keys(now)) compare(name(key), before[key], now[key]);
      } else if (before !== now) changed.push(`    "${path}": ${written(now)},\n`);
    };
    compare("", begin, this.scenario);
    const variant = changed.length ? `scenario = scenario.replace({\n${changed.join("")}})\n` : "";
    return `${code}${variant}run = c2d.simulate(scenario)\nprint(run.reason or run.outcome)\n`;
  }
}

// The keys of a path such as robot.center_of_mass[0].
const keysOf = (path) => path.match(/[^.[\]]+/g);
const valueAt = (object, path) => keysOf(path).reduce((value, key) => value?.[key], object);
