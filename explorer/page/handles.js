// Handles that can be dragged in the picture of the robot: obstacle, wheels, front axle and centre of mass.

// A handle stays at its place while its value follows the pointer, because the robot may end elsewhere.
class Handles {
  constructor(place, state, changed) {
    Object.assign(this, { place, state, changed });
    this.handles = ["obstacle", "wheel", "axle", "mass"].map((name) => {
      const knob = document.createElement("span");
      knob.className = `handle ${name}`;
      knob.setAttribute("aria-hidden", "true"); // the sliders do the same by keyboard
      place.append(knob);
      const handle = { name, knob };
      knob.addEventListener("pointerdown", (event) => this.grab(handle, event));
      knob.addEventListener("pointermove", (event) => this.drag(handle, event));
      for (const end of ["pointerup", "pointercancel"]) {
        knob.addEventListener(end, () => this.release(handle));
      }
      return handle;
    });
  }

  // Places the handles on the robot as shown at an instant; they are hidden while it plays.
  show(scene, time, playing) {
    this.scene = scene;
    this.place.hidden = playing;
    if (playing) return;
    const moment = scene.recording.at(time);
    this.angle = moment.angle;
    scene.camera.look(moment);
    for (const { name, knob } of this.handles) {
      const spot = this.spot(name, moment);
      knob.hidden = !spot;
      if (!spot) continue;
      const [x, y] = scene.camera.screen(...spot);
      knob.style.translate = `${x}px ${y}px`;
      knob.title = this.fields(name).map(({ label }) => label).join(", ");
    }
  }

  // [m] Position of a handle; null if there is nothing to drag.
  spot(name, moment) {
    if (!this.fields(name).length) return null;
    const { robot, lanes } = this.scene;
    const [chassis] = robot.carriers;
    const onChassis = (x, y) => {
      const [right, up] = rotated([x, y], moment.angle);
      return [moment.x + right, moment.y + up];
    };
    if (name === "axle") return onChassis(...chassis.axles[1]);
    if (name === "mass") return onChassis(...robot.massCenter.map(moment.value));
    if (name === "wheel") {
      const wheel = chassis.wheels[chassis.wheels.length >> 1];
      if (!wheel) return null; // while the picture is still that of a belt
      const { x, y } = moment.pose(wheel);
      return onChassis(x, y + wheel.reach);
    }
    const { edges, profile } = lanes.at(-1);
    if (this.state.get("terrain.kind") === "half_round") {
      let top = 0;
      for (let i = 0; i < profile.length; i += 2) if (profile[i + 1] > profile[top + 1]) top = i;
      return [profile[top], profile[top + 1]];
    }
    const corners = edges.filter(({ convex }) => convex);
    const corner = corners[this.state.has("terrain.width") ? 1 : 0];
    return corner ? [corner.x, corner.y] : null;
  }

  // The fields that a handle changes, first those along x, then those along y.
  fields(name) {
    const paths = {
      obstacle: ["terrain.height", "terrain.radius", "terrain.width", "terrain.rise"],
      wheel: ["robot.track.wheel_radius"],
      axle: ["robot.outline.axle_distance"],
      mass: ["robot.center_of_mass[0]", "robot.center_of_mass[1]"],
    }[name];
    return FIELDS.filter((field) => paths.includes(field.path) && applies(field, this.state));
  }

  grab(handle, event) {
    event.preventDefault();
    handle.knob.setPointerCapture(event.pointerId);
    const values = this.fields(handle.name).map(({ path }) => this.state.get(path));
    handle.from = { x: event.clientX, y: event.clientY, angle: this.angle, values };
    this.dragged = handle;
  }

  drag(handle, event) {
    const { from, name } = handle;
    if (!from) return;
    const { scale } = this.scene.camera;
    const moved = [(event.clientX - from.x) / scale, (from.y - event.clientY) / scale];
    // Handles on the robot move along its axes.
    const [along, up] = name === "obstacle" ? moved : rotated(moved, -from.angle);
    const ways = { obstacle: [this.state.has("terrain.width") ? along : up], wheel: [up], axle: [2 * along], mass: [along, up] };
    this.fields(name).forEach((field, i) => {
      const [least, most, step] = field.range;
      const value = step * Math.round((from.values[i] + ways[name][i]) / step);
      this.state.set(field.path, Number(Math.min(most, Math.max(least, value)).toPrecision(6)));
    });
    this.changed(false);
  }

  release(handle) {
    if (!handle.from) return;
    handle.from = this.dragged = null;
    this.changed(true);
  }
}
