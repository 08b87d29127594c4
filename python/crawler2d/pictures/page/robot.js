// The robot in metres: its carriers, each in its pose, and the centre of mass.

class Robot {
  constructor(data) {
    const outlines = data.outlines.map(unpack).map((points) => ({
      path: outlineOf(points), reach: reachOf(points),
    }));
    this.carriers = data.carriers.map((carrier) => new Carrier(carrier, outlines));
    this.massCenter = data.mass_center;
    this.length = data.length;
  }

  // The carriers with the poses of their frames in the world.
  placed(moment) {
    return this.carriers.map((carrier, k) => {
      const { x, y, angle } = moment.pose(carrier);
      const [right, up] = rotated([x, y], moment.angle);
      return { k, carrier, x: moment.x + right, y: moment.y + up, angle: moment.angle + angle };
    });
  }

  // `pixel` is the size of a pixel in metres; `jammed` lists the wheels on either side of an intruding edge.
  draw(ctx, colors, pixel, moment, jammed) {
    for (const { carrier, ...frame } of this.placed(moment)) {
      ctx.save();
      place(ctx, frame);
      carrier.draw(ctx, colors, pixel, moment, jammed);
      ctx.restore();
    }
    ctx.save();
    place(ctx, moment);
    this.drawMassCenter(ctx, colors, pixel, moment);
    ctx.restore();
  }

  // The robot at the end of a trial: outlines only, with a belt round them if the trial closed the track.
  drawGhost(ctx, colors, pixel, moment, { frames, belt }) {
    this.carriers.forEach((carrier, k) => {
      const [x, y, angle] = frames[k];
      ctx.save();
      place(ctx, { x, y, angle });
      carrier.drawGhost(ctx, colors, pixel, moment, belt);
      ctx.restore();
    });
  }

  drawMassCenter(ctx, colors, pixel, moment) {
    const [x, y] = this.massCenter.map(moment.value);
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

// From the frame of the world to that of a carrier and back; likewise from a carrier to a body.
function place(ctx, frame) {
  ctx.translate(frame.x, frame.y);
  ctx.rotate(frame.angle);
}

function unplace(ctx, frame) {
  ctx.rotate(-frame.angle);
  ctx.translate(-frame.x, -frame.y);
}

function rotated([x, y], angle) {
  const cosine = Math.cos(angle);
  const sine = Math.sin(angle);
  return [cosine * x - sine * y, sine * x + cosine * y];
}
