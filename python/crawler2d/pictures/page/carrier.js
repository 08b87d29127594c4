// The chassis, or the flippers at one end, with the bodies that it carries, in metres in its own frame.

class Carrier {
  constructor(data, outlines) {
    Object.assign(this, data);
    const bodies = data.bodies.map((body) => new Body(body, outlines));
    const of = (...looks) => bodies.filter((body) => looks.includes(body.look));
    this.bellies = of("belly");
    this.hulls = of("hull", "guide");
    this.shoes = of("shoe");
    this.wheels = of("wheel", "chain wheel");
    this.inside = of("inside");
    this.circuit = data.circuit && new Circuit(data.circuit, outlines);
    for (const name of ["envelope", "inner", "root"]) {
      if (!data[name]) continue;
      const points = unpack(data[name]);
      this[name] = { points, path: outlineOf(points) };
    }
    this.reach = this.envelope ? reachOf(this.envelope.points) : 0;
  }

  // `pixel` is the size of a pixel in metres; `jammed` lists the wheels on either side of an intruding edge.
  draw(ctx, colors, pixel, moment, jammed) {
    const each = (bodies, draw) => bodies.forEach((body) => {
      ctx.save();
      place(ctx, moment.pose(body));
      draw(body);
      ctx.restore();
    });
    each(this.bellies, ({ path }) => fillAndStroke(ctx, path, colors.chassisFill, colors.chassis, 1.3 * pixel));
    this.drawBar(ctx, colors, pixel);
    each(this.hulls, ({ path }) => {
      ctx.fillStyle = colors.trackFill;
      ctx.fill(path);
    });
    each(this.inside, (wheel) => {
      ctx.scale(INSIDE, INSIDE);
      wheel.drawRound(ctx, colors.track, colors.chassisFill, pixel / INSIDE);
    });
    const travel = this.circuit && moment.value(this.circuit.travel);
    if (this.circuit) this.circuit.drawMarks(ctx, colors, pixel, travel, this.inside[0].reach);
    each(this.hulls, ({ look, path }) => {
      // The guide of shoes is drawn faintly behind them.
      const isHint = look === "guide";
      ctx.strokeStyle = isHint ? colors.chassis : colors.track;
      ctx.lineWidth = (isHint ? 1 : 2) * pixel;
      ctx.stroke(path);
    });
    if (this.circuit) this.circuit.drawGrousers(ctx, colors, travel);
    each(this.wheels, (wheel) => {
      // A carrier without an envelope has a chain: the edge is between shoes, not between wheels.
      const isJammed = this.envelope && jammed.includes(wheel.body);
      wheel.drawRound(ctx, isJammed ? colors.intrusion : colors.track, colors.trackFill, pixel);
    });
    // Stroked as well, so that a thin plate stays visible from afar.
    each(this.shoes, ({ path }) => fillAndStroke(ctx, path, colors.track, colors.track, 0.8 * pixel));
    each(this.shoes, ({ pin, pin_radius: radius }) => {
      ctx.fillStyle = colors.halo;
      ctx.beginPath();
      ctx.arc(pin, 0, Math.min(1.6 * pixel, radius), 0, 2 * Math.PI);
      ctx.fill();
    });
  }

  drawGhost(ctx, colors, pixel, moment, belt) {
    ctx.strokeStyle = colors.speed;
    ctx.fillStyle = colors.trackFill;
    ctx.lineWidth = 1.6 * pixel;
    for (const body of [...this.bellies, ...this.hulls, ...this.wheels]) {
      ctx.save();
      place(ctx, moment.pose(body));
      ctx.fill(body.path);
      ctx.stroke(body.path);
      ctx.restore();
    }
    if (belt && this.envelope) ctx.stroke(this.envelope.path);
  }

  // The line between the end axles.
  drawBar(ctx, colors, pixel) {
    ctx.strokeStyle = colors.chassis;
    ctx.lineWidth = 1.3 * pixel;
    ctx.beginPath();
    for (const axle of this.axles) ctx.lineTo(...axle);
    ctx.stroke();
  }
}

// Wheels inside a belt are drawn smaller, so that the belt stays visible.
const INSIDE = 0.8;

class Body {
  constructor(data, outlines) {
    Object.assign(this, data);
    this.path = new Path2D();
    this.reach = 0; // [m] distance of its farthest point from its origin
    for (const index of data.outlines) {
      this.path.addPath(outlines[index].path);
      this.reach = Math.max(this.reach, outlines[index].reach);
    }
  }

  // The spoke shows the angle of the wheel.
  drawRound(ctx, color, fill, pixel) {
    fillAndStroke(ctx, this.path, fill, color, 1.4 * pixel);
    ctx.fillStyle = color;
    ctx.beginPath();
    ctx.moveTo(0, 0);
    ctx.lineTo(0, 0.82 * this.reach);
    ctx.stroke();
    ctx.beginPath();
    ctx.arc(0, 0, Math.min(2.4 * pixel, 0.25 * this.reach), 0, 2 * Math.PI);
    ctx.fill();
  }
}

// The path of a belt: the pose of anything on it as a function of the distance along it.
class Circuit {
  constructor(data, outlines) {
    Object.assign(this, data);
    for (const name of ["ways", "x", "y", "angle"]) this[name] = unpack(data[name]);
    this.grousers = data.grousers.map((index) => outlines[index].path);
    this.marks = 6 * Math.max(2, Math.min(12, Math.round(data.length / data.pitch / 6)));
  }

  // The last pose is the first one after a full turn.
  pose(way) {
    const { ways, length } = this;
    const there = way - length * Math.floor(way / length);
    let [i, after] = [0, ways.length - 1];
    while (after - i > 1) {
      const middle = (i + after) >> 1;
      if (ways[middle] <= there) i = middle;
      else after = middle;
    }
    const share = (there - ways[i]) / (ways[after] - ways[i]);
    const mixed = (values) => values[i] + share * (values[after] - values[i]);
    return { x: mixed(this.x), y: mixed(this.y), angle: mixed(this.angle) };
  }

  // Marks on the inside of the belt; every sixth is longer.
  drawMarks(ctx, colors, pixel, travel, radius) {
    for (let i = 0; i < this.marks; i++) {
      const isLong = i % 6 === 0;
      ctx.save();
      place(ctx, this.pose(travel + (i / this.marks) * this.length));
      ctx.strokeStyle = isLong ? colors.speed : colors.track;
      ctx.lineWidth = Math.max((isLong ? 3 : 1.6) * pixel, 0.003);
      ctx.beginPath();
      ctx.moveTo(0, 0);
      ctx.lineTo(0, -(isLong ? 0.2 : 0.11) * radius);
      ctx.stroke();
      ctx.restore();
    }
  }

  drawGrousers(ctx, colors, travel) {
    ctx.fillStyle = colors.track;
    this.grousers.forEach((path, i) => {
      ctx.save();
      place(ctx, this.pose(travel + this.starts[i]));
      ctx.fill(path);
      ctx.restore();
    });
  }
}

function fillAndStroke(ctx, path, fill, stroke, width) {
  ctx.fillStyle = fill;
  ctx.fill(path);
  ctx.strokeStyle = stroke;
  ctx.lineWidth = width;
  ctx.stroke(path);
}
