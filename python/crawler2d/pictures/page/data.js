// The recorded run: frames, contacts and events, and the state at an instant between two frames.

// Little-endian, as written by Python; every machine that shows the page is little-endian, too.
function unpack(column) {
  if (ArrayBuffer.isView(column)) return column; // from the core of the explorer
  const bytes = Uint8Array.from(atob(column.data), (letter) => letter.charCodeAt(0));
  if (column.bits === 32) return new Float32Array(bytes.buffer);
  const counts = column.bits === 16 ? new Uint16Array(bytes.buffer) : bytes;
  return Float64Array.from(counts, (count) => column.start + column.step * count);
}

// A path through points, closed unless `close` is false.
function outlineOf(points, close = true) {
  const path = new Path2D();
  for (let i = 0; i < points.length; i += 2) path.lineTo(points[i], points[i + 1]);
  if (close) path.closePath();
  return path;
}

// [m] Distance of the farthest of the points from the origin.
function reachOf(points) {
  let reach = 0;
  for (let i = 0; i < points.length; i += 2) {
    reach = Math.max(reach, Math.hypot(points[i], points[i + 1]));
  }
  return reach;
}

class Recording {
  constructor(data) {
    const { frames, contacts } = data;
    this.count = frames.count;
    this.events = data.events;
    for (const name of ["time", "x", "y", "angle", "speed", "commanded"]) {
      this[name] = unpack(frames[name]);
    }
    this.columns = data.robot.columns.map(unpack);
    this.contacts = {};
    for (const name of ["x", "y", "normal", "normal_force", "friction_force", "surface_speed"]) {
      this.contacts[name] = unpack(contacts[name]);
    }
    this.firstContact = [0];
    for (const many of unpack(contacts.counts)) {
      this.firstContact.push(this.firstContact.at(-1) + Math.round(many));
    }
    this.begin = this.time[0];
    this.end = this.time[this.count - 1];
  }

  // The frame at or after an instant; its contacts are means over the interval that ends with it.
  frameAfter(time) {
    let low = 0;
    let high = this.count - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.time[middle] < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  nearestFrame(time) {
    const after = this.frameAfter(time);
    const earlier = after > 0 && time - this.time[after - 1] < this.time[after] - time;
    return earlier ? after - 1 : after;
  }

  // The pose at an instant, interpolated linearly between frames.
  at(time) {
    const frame = this.frameAfter(time);
    const before = Math.max(frame - 1, 0);
    const span = this.time[frame] - this.time[before];
    const share = span > 0 ? Math.min(1, Math.max(0, (time - this.time[before]) / span)) : 1;
    const mixed = (values) => values[before] + share * (values[frame] - values[before]);
    // A constant quantity is stored as a plain number.
    const value = (entry) => (entry.column === undefined ? entry : mixed(this.columns[entry.column]));
    return {
      time, frame, value,
      x: mixed(this.x), y: mixed(this.y), angle: mixed(this.angle), speed: mixed(this.speed),
      // The pose of a carrier in the chassis frame, or of a body in the frame of its carrier.
      pose: ({ x, y, angle }) => ({ x: value(x), y: value(y), angle: value(angle) }),
    };
  }

  *contactsOf(frame) {
    const c = this.contacts;
    for (let i = this.firstContact[frame]; i < this.firstContact[frame + 1]; i++) {
      const nx = Math.cos(c.normal[i]);
      const ny = Math.sin(c.normal[i]);
      // Friction and surface speed are positive along the normal turned by -90 degrees.
      yield {
        x: c.x[i], y: c.y[i], nx, ny,
        fx: c.normal_force[i] * nx + c.friction_force[i] * ny,
        fy: c.normal_force[i] * ny - c.friction_force[i] * nx,
        vx: c.surface_speed[i] * ny, vy: -c.surface_speed[i] * nx,
      };
    }
  }

  eventsAt(time, kind) {
    const slack = 1e-4; // times are rounded to this
    return this.events.filter(
      (e) => e.kind === kind && e.start - slack <= time && time <= e.end + slack,
    );
  }
}
