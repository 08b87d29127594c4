// The robot in its chassis frame, in metres: chassis, wheels, gears, belt, and what surrounds them.

class Robot {
  constructor(data) {
    Object.assign(this, data);
    for (const wheel of [...this.wheels, ...this.ends]) {
      if (wheel.outline) wheel.path = outlineOf(unpacked(wheel.outline));
    }
    for (const name of ["hull", "envelope", "inner", "root", "belly"]) {
      if (!data[name]) continue;
      const points = unpacked(data[name]);
      this[name] = { points, path: outlineOf(points) };
    }
    if (this.hull) this.marks = marksOf(this.hull.points, this.pitch);
    this.grousers = this.grousers.map((grouser) => outlineOf(unpacked(grouser)));
    this.shoes = this.shoes.map((pieces) => {
      const path = new Path2D();
      for (const piece of pieces) path.addPath(outlineOf(unpacked(piece)));
      return path;
    });
  }

  // `pixel` is the length of one; `jammed` are the wheels that an edge is between.
  draw(ctx, colors, pixel, moment, jammed) {
    this.drawChassis(ctx, colors, pixel);
    if (this.hull) this.drawHull(ctx, colors, pixel, moment);
    for (const wheel of this.wheels) {
      const color = jammed.includes(wheel.body) ? colors.intrusion : colors.track;
      ctx.save();
      ctx.translate(wheel.x, wheel.y);
      ctx.rotate(-moment.way(wheel.drive) / wheel.radius);
      drawWheel(ctx, wheel, color, colors.trackFill, pixel);
      ctx.restore();
    }
    this.drawMassCenter(ctx, colors, pixel);
  }

  drawChassis(ctx, colors, pixel) {
    ctx.strokeStyle = colors.chassis;
    ctx.lineWidth = 1.3 * pixel;
    if (this.belly) {
      ctx.fillStyle = colors.chassisFill;
      ctx.fill(this.belly.path);
      ctx.stroke(this.belly.path);
    }
    ctx.beginPath();
    ctx.moveTo(-this.axles, 0);
    ctx.lineTo(this.axles, 0);
    ctx.stroke();
  }

  drawHull(ctx, colors, pixel, moment) {
    ctx.fillStyle = colors.trackFill;
    ctx.fill(this.hull.path);
    ctx.strokeStyle = colors.track;
    for (const end of this.moving ? this.ends : []) {
      ctx.save();
      ctx.translate(end.x, end.y);
      ctx.rotate(-moment.way(end.drive) / end.radius);
      const shown = this.rolling ? end : { radius: 0.8 * end.radius };
      drawWheel(ctx, shown, colors.track, colors.chassisFill, pixel);
      ctx.restore();
    }
    const { length, at, spacing, count } = this.marks;
    // Skids do not move, and so bear no marks; shoes are marks enough.
    for (let i = 0; this.moving && !this.shoes.length && i < count; i++) {
      const [x, y, nx, ny] = at(i * spacing - moment.way(this.ends[0].drive), length);
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
    ctx.strokeStyle = this.shoes.length ? colors.chassis : colors.track;
    ctx.lineWidth = (this.shoes.length ? 1 : 2) * pixel;
    if (!this.rolling) ctx.stroke(this.hull.path);
    this.grousers.forEach((grouser, i) => {
      // They start at the rear end of the lower run, and the belt runs clockwise.
      const way = this.marks.lower - (i / this.grousers.length) * length - moment.way(this.ends[0].drive);
      const [x, y, nx, ny] = at(way);
      ctx.save();
      ctx.translate(x, y);
      ctx.rotate(Math.atan2(nx, -ny));
      ctx.fillStyle = colors.track;
      ctx.fill(grouser);
      ctx.restore();
    });
    this.drawShoes(ctx, colors, pixel, moment);
  }

  // Each between its rear pin and that of the next one.
  drawShoes(ctx, colors, pixel, moment) {
    const pins = this.shoes.map((_, i) => moment.pin(i));
    this.shoes.forEach((shoe, i) => {
      const [x, y] = pins[i];
      const [nextX, nextY] = pins[(i + 1) % pins.length];
      ctx.save();
      ctx.translate((x + nextX) / 2, (y + nextY) / 2);
      ctx.rotate(Math.atan2(nextY - y, nextX - x));
      ctx.fillStyle = ctx.strokeStyle = colors.track;
      ctx.lineWidth = 0.8 * pixel; // so that a thin plate is seen from afar
      ctx.fill(shoe);
      ctx.stroke(shoe);
      ctx.restore();
    });
    ctx.fillStyle = colors.halo;
    for (const [x, y] of pins) {
      ctx.beginPath();
      ctx.arc(x, y, Math.min(1.6 * pixel, this.pin_radius), 0, 2 * Math.PI);
      ctx.fill();
    }
  }

  drawMassCenter(ctx, colors, pixel) {
    const [x, y] = this.mass_center;
    const radius = 5 * pixel;
    ctx.lineWidth = 1.2 * pixel;
    ctx.strokeStyle = ctx.fillStyle = colors.ink;
    for (const quarter of [0, 1, 2, 3]) {
      ctx.beginPath();
      ctx.moveTo(x, y);
      ctx.arc(x, y, radius, (quarter * Math.PI) / 2, ((quarter + 1) * Math.PI) / 2);
      ctx.closePath();
      if (quarter % 2) ctx.fill();
      ctx.stroke();
    }
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
