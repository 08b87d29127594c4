// The ground under one track: its surface, its corners, and the pieces of it inside an envelope.

class Lane {
  constructor(data) {
    this.profile = unpack(data.profile);
    this.surface = outlineOf(this.profile, false);
    this.edges = data.corners.map((corner, i) => ({
      lane: data.lane, id: data.ids[i], corner, convex: data.convex[i],
      x: this.profile[2 * corner], y: this.profile[2 * corner + 1],
    }));
  }

  // The ground as an area, down to a height [m] or to a metre below its lowest point.
  soil(floor) {
    const { profile } = this;
    const path = new Path2D(this.surface);
    let deepest = floor;
    for (let i = 1; i < profile.length; i += 2) deepest = Math.min(deepest, profile[i] - 1);
    path.lineTo(profile[profile.length - 2], deepest);
    path.lineTo(profile[0], deepest);
    path.closePath();
    return path;
  }

  // [m] Range of x over which the surface about a corner is inside; `depth` gives the depth of a point.
  piece(corner, depth) {
    const at = (i) => ({ x: this.profile[2 * i], y: this.profile[2 * i + 1] });
    const last = this.profile.length / 2 - 1;
    return [-1, 1].map((step) => {
      let i = corner;
      while (i + step >= 0 && i + step <= last && depth(at(i + step)) > 0) i += step;
      let inside = at(i);
      let outside = at(Math.min(last, Math.max(0, i + step)));
      for (let k = 0; k < 30; k++) {
        const middle = { x: (inside.x + outside.x) / 2, y: (inside.y + outside.y) / 2 };
        if (depth(middle) > 0) inside = middle;
        else outside = middle;
      }
      return inside.x;
    });
  }
}
