// What runs round the chassis or a flipper, in its frame, in metres: wheels, gears or a belt.

class Track {
  // `guides` one that shoes slide on; the others may bear marks a grouser pitch [m] apart.
  constructor(data, pitch, guides = false) {
    const { wheels, ends, moving } = data;
    Object.assign(this, { wheels, ends, moving, guides });
    for (const wheel of [...wheels, ...ends]) {
      if (wheel.outline) wheel.path = outlineOf(unpacked(wheel.outline));
    }
    for (const name of ["hull", "envelope", "inner", "root"]) {
      if (!data[name]) continue;
      const points = unpacked(data[name]);
      this[name] = { points, path: outlineOf(points) };
    }
    if (this.hull) this.marks = marksOf(this.hull.points, pitch);
    this.grousers = data.grousers.map((grouser) => outlineOf(unpacked(grouser)));
    this.reach = 0; // [m] of the envelope
    const { points } = this.envelope ?? { points: [] };
    for (let i = 0; i < points.length; i += 2) {
      this.reach = Math.max(this.reach, Math.hypot(points[i], points[i + 1]));
    }
  }

  // `way` tells how far a drive has run; `jammed` are the wheels that an edge is between.
  draw(ctx, colors, pixel, way, jammed) {
    if (this.hull) this.drawHull(ctx, colors, pixel, way);
    for (const wheel of this.wheels) {
      // Without an envelope the wheels are in a chain: the edge is between its shoes.
      const color = this.envelope && jammed.includes(wheel.body) ? colors.intrusion : colors.track;
      ctx.save();
      ctx.translate(wheel.x, wheel.y);
      ctx.rotate(-way(wheel.drive) / wheel.radius);
      drawWheel(ctx, wheel, color, colors.trackFill, pixel);
      ctx.restore();
    }
  }

  drawHull(ctx, colors, pixel, way) {
    ctx.fillStyle = colors.trackFill;
    ctx.fill(this.hull.path);
    ctx.strokeStyle = colors.track;
    for (const end of this.moving ? this.ends : []) {
      ctx.save();
      ctx.translate(end.x, end.y);
      ctx.rotate(-way(end.drive) / end.radius);
      drawWheel(ctx, { radius: 0.8 * end.radius }, colors.track, colors.chassisFill, pixel);
      ctx.restore();
    }
    const { length, at, spacing, count } = this.marks;
    // Skids do not move, and so bear no marks; shoes are marks enough.
    for (let i = 0; this.moving && !this.guides && i < count; i++) {
      const [x, y, nx, ny] = at(i * spacing - way(this.ends[0].drive), length);
      const long = i % 6 === 0;
      const depth = (long ? 0.2 : 0.11) * this.ends[0].radius;
      ctx.strokeStyle = long ? colors.speed : colors.track;
      ctx.lineWidth = Math.max((long ? 3 : 1.6) * pixel, 0.003);
      ctx.beginPath();
      ctx.moveTo(x, y);
      ctx.lineTo(x + depth * nx, y + depth * ny);
      ctx.stroke();
    }
    // What shoes slide on is no more than a hint behind them.
    ctx.strokeStyle = this.guides ? colors.chassis : colors.track;
    ctx.lineWidth = (this.guides ? 1 : 2) * pixel;
    ctx.stroke(this.hull.path);
    this.grousers.forEach((grouser, i) => {
      // They start at the rear end of the lower run, and the belt runs clockwise.
      const start = this.marks.lower - (i / this.grousers.length) * length;
      const [x, y, nx, ny] = at(start - way(this.ends[0].drive));
      ctx.save();
      ctx.translate(x, y);
      ctx.rotate(Math.atan2(nx, -ny));
      ctx.fillStyle = colors.track;
      ctx.fill(grouser);
      ctx.restore();
    });
  }
}

// About its own centre; the spoke shows how far it has turned.
function drawWheel(ctx, wheel, color, fill, pixel) {
  let path = wheel.path;
  if (!path) {
    path = new Path2D();
    path.arc(0, 0, wheel.radius, 0, 2 * Math.PI);
  }
  ctx.fillStyle = fill;
  ctx.fill(path);
  ctx.strokeStyle = ctx.fillStyle = color;
  ctx.lineWidth = 1.4 * pixel;
  ctx.stroke(path);
  ctx.beginPath();
  ctx.moveTo(0, 0);
  ctx.lineTo(0, 0.82 * wheel.radius);
  ctx.stroke();
  ctx.beginPath();
  ctx.arc(0, 0, Math.min(2.4 * pixel, 0.25 * wheel.radius), 0, 2 * Math.PI);
  ctx.fill();
}

// Evenly spaced places along a closed line, counter-clockwise: point and inward normal.
function marksOf(points, pitch) {
  const n = points.length / 2;
  const lengths = [0];
  for (let i = 0; i < n; i++) {
    const j = (i + 1) % n;
    const way = Math.hypot(points[2 * j] - points[2 * i], points[2 * j + 1] - points[2 * i + 1]);
    lengths.push(lengths[i] + way);
  }
  const length = lengths[n];
  const count = 6 * Math.max(2, Math.min(12, Math.round(length / pitch / 6)));
  const at = (way) => {
    const s = ((way % length) + length) % length;
    let i = 0;
    while (i < n - 1 && lengths[i + 1] <= s) i++;
    const j = (i + 1) % n;
    const dx = points[2 * j] - points[2 * i];
    const dy = points[2 * j + 1] - points[2 * i + 1];
    const part = Math.hypot(dx, dy) || 1;
    const share = (s - lengths[i]) / part;
    return [points[2 * i] + share * dx, points[2 * i + 1] + share * dy, -dy / part, dx / part];
  };
  // The last side is the lower run; `lower` is where its rear end is.
  return { length, at, count, spacing: length / count, lower: lengths[n - 1] };
}
