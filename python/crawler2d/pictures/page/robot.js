// The robot in metres: chassis, track and flippers, each where it is.

class Robot {
  constructor(data) {
    Object.assign(this, data);
    this.belly = data.belly && outlineOf(unpacked(data.belly));
    this.shoes = data.shoes.map((pieces) => {
      const path = new Path2D();
      for (const piece of pieces) path.addPath(outlineOf(unpacked(piece)));
      return path;
    });
    const guides = this.shoes.length > 0;
    this.tracks = [data, ...data.flippers].map((track, i) => new Track(track, data.pitch, guides && !i));
  }

  // What carries a track, the chassis and then the flippers: where its frame is, and how far the
  // surface of a drive has run over it.
  carriers(moment) {
    const { x, y, angle, way } = moment;
    const flippers = this.flippers.map(({ pivot, arm, sign }, k) => {
      const turn = sign * moment.flipper(k);
      const [pivotX, pivotY] = rotated(pivot, angle);
      const [armX, armY] = rotated(arm, angle + turn);
      return {
        x: x + pivotX + armX, y: y + pivotY + armY, angle: angle + turn,
        // The sprocket turns with the chassis: over a flipper that turns it turns back.
        way: (drive) => way(drive) + this.drive_radius * turn,
      };
    });
    return [{ x, y, angle, way }, ...flippers].map((carrier, k) => ({ ...carrier, k, track: this.tracks[k] }));
  }

  // `pixel` is the length of one; `jammed` are the wheels that an edge is between.
  draw(ctx, colors, pixel, moment, jammed) {
    const [chassis, ...flippers] = this.carriers(moment);
    ctx.save();
    place(ctx, chassis);
    this.drawChassis(ctx, colors, pixel);
    chassis.track.draw(ctx, colors, pixel, chassis.way, jammed);
    this.drawShoes(ctx, colors, pixel, moment);
    ctx.restore();
    flippers.forEach(({ track, way, ...pose }, k) => {
      const [x, y] = this.flippers[k].arm;
      ctx.save();
      place(ctx, pose);
      drawBar(ctx, colors, pixel, [-x, -y], [x, y]);
      track.draw(ctx, colors, pixel, way, jammed);
      ctx.restore();
    });
    ctx.save();
    place(ctx, chassis);
    this.drawMassCenter(ctx, colors, pixel, moment);
    ctx.restore();
  }

  drawChassis(ctx, colors, pixel) {
    if (this.belly) {
      ctx.strokeStyle = colors.chassis;
      ctx.lineWidth = 1.3 * pixel;
      ctx.fillStyle = colors.chassisFill;
      ctx.fill(this.belly);
      ctx.stroke(this.belly);
    }
    drawBar(ctx, colors, pixel, [-this.axles, 0], [this.axles, 0]);
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

  // It moves with the flippers.
  drawMassCenter(ctx, colors, pixel, moment) {
    let [x, y] = this.mass_center;
    this.flippers.forEach(({ arm, sign }, k) => {
      const there = rotated(arm, sign * moment.flipper(k));
      x += this.flipper_mass_share * (there[0] - arm[0]);
      y += this.flipper_mass_share * (there[1] - arm[1]);
    });
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

// From axle to axle, in the frame of what carries them.
function drawBar(ctx, colors, pixel, from, to) {
  ctx.strokeStyle = colors.chassis;
  ctx.lineWidth = 1.3 * pixel;
  ctx.beginPath();
  ctx.moveTo(...from);
  ctx.lineTo(...to);
  ctx.stroke();
}

// From the frame of the world to that of a carrier, and back.
function place(ctx, carrier) {
  ctx.translate(carrier.x, carrier.y);
  ctx.rotate(carrier.angle);
}

function unplace(ctx, carrier) {
  ctx.rotate(-carrier.angle);
  ctx.translate(-carrier.x, -carrier.y);
}

function rotated([x, y], angle) {
  const cosine = Math.cos(angle);
  const sine = Math.sin(angle);
  return [cosine * x - sine * y, sine * x + cosine * y];
}
