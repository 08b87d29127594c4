// The side view: ground, goal, path, robot, intrusions, and contact forces.

class Scene {
  constructor(canvas, data, recording) {
    this.canvas = canvas;
    this.recording = recording;
    this.robot = new Robot(data.robot);
    this.camera = new Camera(data.extent, data.robot.length);
    this.lanes = data.ground.lanes.map((lane) => new Lane(lane)); // the farthest first
    this.goal = data.ground.goal;
    this.layers = { forces: true, speeds: true, envelope: true };
    this.ghosts = data.ghosts;
    this.ghost = null; // the trial whose end is shown
    this.forceScale = FORCE_LENGTH / (data.contacts.usual_force || 1);
    this.speedScale = SPEED_LENGTH / (data.contacts.usual_speed || 1);
    this.route = outlineOf(Float64Array.from({ length: 2 * recording.count }, (_, i) =>
      (i % 2 ? recording.y : recording.x)[i >> 1]), false);
  }

  // Whether this run has anything of this kind to draw.
  has(what) {
    if (what === "envelope") return this.robot.carriers.some((carrier) => carrier.envelope);
    const { normal_force: normal, friction_force: friction, surface_speed: speed } =
      this.recording.contacts;
    if (what === "contacts") return normal.length > 0;
    if (what === "cut") {
      const longest = (scale, values) => values.some((v) => Math.abs(v) * scale > LONGEST);
      return longest(this.forceScale / FORCE_LENGTH, normal.map((n, i) => Math.hypot(n, friction[i])))
        || longest(this.speedScale / SPEED_LENGTH, speed);
    }
    return this.recording.events.some((event) => event.kind === what);
  }

  draw(time, colors) {
    const ctx = this.canvas.getContext("2d");
    const ratio = this.canvas.width / this.camera.width;
    const moment = this.recording.at(time);
    const { camera, robot } = this;
    camera.look(moment);
    const pixel = 1 / camera.scale;
    ctx.save(); // keeps styles from leaking into the next frame
    ctx.lineJoin = "round";
    ctx.setTransform(1, 0, 0, 1, 0, 0);
    ctx.clearRect(0, 0, this.canvas.width, this.canvas.height);
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.drawGrid(ctx, colors);
    camera.apply(ctx, ratio);
    const floor = camera.middleY - camera.height / camera.scale;
    this.drawGround(ctx, colors, pixel, floor);
    ctx.strokeStyle = colors.goal;
    ctx.globalAlpha = 0.45;
    ctx.lineWidth = 1.4 * pixel;
    ctx.stroke(this.route);
    ctx.globalAlpha = 1;

    const jams = this.recording.eventsAt(time, "intrusion");
    const jammed = jams.flatMap((e) => (e.bodies[0] === e.bodies[1] ? [] : e.bodies));
    robot.draw(ctx, colors, pixel, moment, jammed);
    ctx.strokeStyle = colors.groundLine;
    ctx.lineWidth = 1.8 * pixel;
    ctx.stroke(this.lanes.at(-1).surface);
    const belted = this.layers.envelope ? robot.placed(moment).filter((p) => p.carrier.envelope) : [];
    for (const placed of belted) this.drawEnvelope(ctx, colors, pixel, placed, floor);

    if (this.ghost !== null) robot.drawGhost(ctx, colors, pixel, moment, this.ghosts[this.ghost]);

    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.drawGoal(ctx, colors);
    this.drawEdges(ctx, colors, belted, jams);
    if (this.layers.forces || this.layers.speeds) this.drawContacts(ctx, colors, moment);
    this.drawScale(ctx, colors);
    ctx.restore();
  }

  // If there are two lanes, the far one is visible through the near one.
  drawGround(ctx, colors, pixel, floor) {
    for (const lane of this.lanes) {
      const near = lane === this.lanes.at(-1);
      ctx.globalAlpha = near ? (this.lanes.length > 1 ? 0.75 : 1) : 0.55;
      ctx.fillStyle = colors.ground;
      ctx.fill(lane.soil(floor));
      ctx.globalAlpha = 1;
      if (near) continue;
      ctx.strokeStyle = colors.groundLine;
      ctx.lineWidth = 1.2 * pixel;
      ctx.setLineDash([8 * pixel, 4 * pixel]);
      ctx.stroke(lane.surface);
      ctx.setLineDash([]);
    }
  }

  drawEnvelope(ctx, colors, pixel, placed, floor) {
    const { envelope, inner, root, reach } = placed.carrier;
    ctx.save();
    place(ctx, placed);
    ctx.strokeStyle = colors.intrusion;
    ctx.lineWidth = 1.3 * pixel;
    ctx.setLineDash([6 * pixel, 4 * pixel]);
    ctx.stroke(envelope.path);
    if (root) {
      ctx.lineWidth = pixel;
      ctx.setLineDash([1.5 * pixel, 3 * pixel]);
      ctx.stroke(root.path);
    }
    ctx.setLineDash([]);
    // The clip outlives the change of transform, so only soil inside the belt is filled.
    ctx.clip(inner.path);
    unplace(ctx, placed);
    for (const lane of this.lanes) {
      const pieces = new Path2D();
      for (const edge of lane.edges) {
        if (!edge.convex || !(depthIn(placed, edge) > 0)) continue;
        const [left, right] = lane.piece(edge.corner, (point) => depthIn(placed, point));
        pieces.rect(left - pixel, placed.y - reach, right - left + 2 * pixel, 2 * reach);
      }
      ctx.save();
      ctx.clip(pieces);
      ctx.fillStyle = colors.intrusionFill;
      ctx.fill(lane.soil(floor));
      ctx.strokeStyle = colors.intrusion;
      ctx.lineWidth = 3 * pixel;
      ctx.stroke(lane.surface);
      ctx.restore();
    }
    ctx.restore();
  }

  // `belted` lists the carriers whose belts are shown, `jams` the current intrusions.
  drawEdges(ctx, colors, belted, jams) {
    let deepest = null;
    for (const edge of this.lanes.flatMap((lane) => lane.edges)) {
      const [x, y] = this.camera.screen(edge.x, edge.y);
      for (const placed of edge.convex ? belted : []) {
        const depth = depthIn(placed, edge);
        if (depth > (deepest?.depth ?? 0)) deepest = { depth, x, y, edge, k: placed.k };
      }
      diamond(ctx, x, y, 4.5, edge.convex ? colors.groundLine : colors.ground, colors.groundLine);
    }
    if (!deepest) return;
    diamond(ctx, deepest.x, deepest.y, 6.5, colors.halo, colors.intrusion);
    const { lane, id } = deepest.edge;
    const isIt = (e) => e.lane === lane && e.edge === id && e.carrier === deepest.k;
    const jam = jams.filter(isIt).at(-1);
    const millimetres = (1e3 * deepest.depth).toFixed(1);
    const where = jam && jam.bodies.length === 2 && jam.bodies[0] !== jam.bodies[1]
      ? `between wheels ${Math.min(...jam.bodies)} and ${Math.max(...jam.bodies)}` : "";
    const below = deepest.y + deepest.depth * this.camera.scale + 26; // below the filled area
    [`${millimetres} mm inside`, where].forEach((text, line) => {
      const y = below + 15 * line;
      label(ctx, text, deepest.x + 14, y, colors.intrusion, colors.halo, this.camera.width);
    });
  }

  drawContacts(ctx, colors, moment) {
    for (const c of this.recording.contactsOf(moment.frame)) {
      const [x, y] = this.camera.screen(c.x, c.y);
      if (this.layers.speeds) {
        // Drawn below the ground line, where it hides nothing.
        const s = this.speedScale;
        arrow(ctx, x - 8 * c.nx, y + 8 * c.ny, c.vx * s, c.vy * s, SPEED_LENGTH, colors.speed, colors.ground);
      }
      if (this.layers.forces) {
        const s = this.forceScale;
        arrow(ctx, x, y, c.fx * s, c.fy * s, FORCE_LENGTH, colors.force, colors.halo);
      }
    }
  }

  drawGoal(ctx, colors) {
    if (this.goal === null) return;
    const [x] = this.camera.screen(this.goal, 0);
    if (x < -50 || x > this.camera.width + 50) return;
    ctx.strokeStyle = colors.goal;
    ctx.lineWidth = 1.4;
    ctx.setLineDash([2, 5]);
    ctx.beginPath();
    ctx.moveTo(x, 0);
    ctx.lineTo(x, this.camera.height);
    ctx.stroke();
    ctx.setLineDash([]);
    label(ctx, "goal (rear end)", x + 6, 44, colors.goal, colors.halo, this.camera.width);
  }

  drawGrid(ctx, colors) {
    const { camera } = this;
    const step = nice(80 / camera.scale);
    ctx.strokeStyle = colors.grid;
    ctx.lineWidth = 1;
    ctx.beginPath();
    const halfWidth = camera.width / 2 / camera.scale;
    const halfHeight = camera.height / 2 / camera.scale;
    for (let k = Math.ceil((camera.middleX - halfWidth) / step); k * step < camera.middleX + halfWidth; k++) {
      const x = Math.round(camera.screen(k * step, 0)[0]) + 0.5;
      ctx.moveTo(x, 0);
      ctx.lineTo(x, camera.height);
    }
    for (let k = Math.ceil((camera.middleY - halfHeight) / step); k * step < camera.middleY + halfHeight; k++) {
      const y = Math.round(camera.screen(0, k * step)[1]) + 0.5;
      ctx.moveTo(0, y);
      ctx.lineTo(camera.width, y);
    }
    ctx.stroke();
  }

  drawScale(ctx, colors) {
    const { camera } = this;
    const length = nice(80 / camera.scale);
    const pixels = length * camera.scale;
    const y = camera.height - 12;
    ctx.strokeStyle = colors.ink;
    ctx.lineWidth = 1.5;
    ctx.beginPath();
    ctx.moveTo(12, y - 5);
    ctx.lineTo(12, y);
    ctx.lineTo(12 + pixels, y);
    ctx.lineTo(12 + pixels, y - 5);
    ctx.stroke();
    const text = length < 1 ? `${+(1e3 * length).toPrecision(3)} mm` : `${length} m`;
    ctx.font = FONT;
    ctx.textAlign = "center";
    ctx.fillStyle = colors.ink;
    ctx.fillText(text, 12 + pixels / 2, y - 7);
    ctx.textAlign = "left";
  }
}

// [m] Depth of a point inside the envelope of a carrier, which is convex; 0 outside.
function depthIn({ carrier, ...frame }, point) {
  const { envelope, inner, reach } = carrier;
  const away = [point.x - frame.x, point.y - frame.y];
  if (Math.hypot(...away) > reach) return 0;
  const [x, y] = rotated(away, -frame.angle);
  return clearance(inner.points, x, y) > 0 ? clearance(envelope.points, x, y) : 0;
}

// [m] Distance of a point from the nearest side of a convex counter-clockwise polygon; < 0 outside.
function clearance(points, x, y) {
  let least = Infinity;
  for (let i = 0; i < points.length; i += 2) {
    const j = (i + 2) % points.length;
    const dx = points[j] - points[i];
    const dy = points[j + 1] - points[i + 1];
    const length = Math.hypot(dx, dy);
    if (length < 1e-6) continue;
    least = Math.min(least, (dx * (y - points[i + 1]) - dy * (x - points[i])) / length);
  }
  return least;
}
